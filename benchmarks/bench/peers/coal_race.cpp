// Coal's functor in C++ on two ellipsoids: reads poses, prints the time of a frame, writes answers.
// Arguments: poses (rows of 24 doubles: two 3 x 4 by rows, after six semi-axes), answers, frames.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <vector>

#include <coal/distance.h>
#include <coal/shape/geometric_shapes.h>

static coal::Transform3s place(const double* row) {
  coal::Matrix3s turn;
  coal::Vec3s shift;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) turn(i, j) = row[4 * i + j];
    shift[i] = row[4 * i + 3];
  }
  return coal::Transform3s(turn, shift);
}

int main(int, char** given) {
  const int frames = std::atoi(given[3]);
  std::vector<double> axes(6), poses(24 * (frames + 1)), answers;
  std::ifstream file(given[1], std::ios::binary);
  file.read(reinterpret_cast<char*>(axes.data()), 8 * axes.size());
  file.read(reinterpret_cast<char*>(poses.data()), 8 * poses.size());
  if (!file) return 2;
  coal::Ellipsoid a(axes[0], axes[1], axes[2]), b(axes[3], axes[4], axes[5]);
  coal::ComputeDistance query(&a, &b);
  coal::DistanceRequest request;
  request.gjk_initial_guess = coal::GJKInitialGuess::CachedGuess;
  coal::DistanceResult result;
  answers.reserve(7 * frames);
  double best = 1e9;
  for (int pass = 0; pass < 3; ++pass) {  // the first warms up
    answers.clear();
    const auto begun = std::chrono::steady_clock::now();
    for (int k = 1; k <= frames; ++k) {
      const double* row = &poses[24 * k];
      result.clear();
      answers.push_back(query(place(row), place(row + 12), request, result));
      request.updateGuess(result);
      for (const auto& point : result.nearest_points)
        for (int i = 0; i < 3; ++i) answers.push_back(point[i]);
    }
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begun;
    if (pass > 0 && taken.count() < best) best = taken.count();
  }
  std::ofstream(given[2], std::ios::binary)
      .write(reinterpret_cast<const char*>(answers.data()), 8 * answers.size());
  std::printf("%.17g\n", best);
}
