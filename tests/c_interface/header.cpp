// The header in a C++ program, with the codes that need no pair.
#include <cmath>
#include <cstdio>

#include "standoff.h"

int main(int count, char **words)
{
    standoff_pose pose = {{1, 1e-7f, 0, -1e-7f, 1, 0, 0, 0, 1}, {0, 0, 0}};
    standoff_pose far = {{2, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    standoff_pose mirrored = {{-1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    standoff_pair *pair = nullptr;
    const bool mended = standoff_orthonormalise(&pose) == STANDOFF_OK &&
                        std::fabs(pose.rotation[0] * pose.rotation[1] +
                                  pose.rotation[3] * pose.rotation[4]) < 1e-15;
    const bool refused = standoff_orthonormalise(&far) == STANDOFF_BAD_POSE_A &&
                         standoff_orthonormalise(&mirrored) == STANDOFF_BAD_POSE_A &&
                         far.rotation[0] == 2.0;
    const bool null = standoff_load(nullptr, &pair) == STANDOFF_NULL &&
                      standoff_load("nowhere", &pair) == STANDOFF_NO_FILE && pair == nullptr &&
                      standoff_start(pair, &pose, &pose, nullptr, nullptr, nullptr, nullptr) ==
                          STANDOFF_NULL;
    standoff_free(nullptr);
    if (count > 2) {  // a state of one pair is none of another
        standoff_pair *own = nullptr, *other = nullptr;
        standoff_state state;
        standoff_answer answer;
        const standoff_pose home = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
        const standoff_pose away = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 3}};
        standoff_load(words[1], &own);
        standoff_load(words[2], &other);
        standoff_start(own, &home, &away, nullptr, nullptr, &state, &answer);
        const int mine =
            standoff_step(own, &state, &home, &away, nullptr, nullptr, 1e-3, &answer);
        const int not_mine =
            standoff_step(other, &state, &home, &away, nullptr, nullptr, 1e-3, &answer);
        std::printf("%d %d %d %d %d %g\n", mine, not_mine,
                    standoff_features(own, 0, STANDOFF_EDGE),
                    standoff_features(own, 2, STANDOFF_EDGE),
                    standoff_switches(other, &state, nullptr, 0), standoff_frame_time(own));
        standoff_free(own);
        standoff_free(other);
        return 0;
    }
    std::printf("%s %d %d %d\n", standoff_version(), mended, refused, null);
    return mended && refused && null ? 0 : 1;
}
