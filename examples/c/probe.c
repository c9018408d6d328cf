/* A ball moves over a box and around an edge at 1 kHz; where it enters, a spring pushes it out.
 *
 *   python save_pair.py
 *   standoff c-library build
 *   cc probe.c -Ibuild -Lbuild -lstandoff -lm -Wl,-rpath,'$ORIGIN/build' -o probe
 *   ./probe
 */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "standoff.h"

#define STIFFNESS 800.0 /* N/m */
#define TICKS 2000
#define DT 1e-3 /* s */

static void check(int code)
{
    if (code != STANDOFF_OK) {
        fprintf(stderr, "standoff: %s\n", standoff_message(code));
        exit(1);
    }
}

/* Where a hand would hold the ball at a time: along the top of the box, then around its edge, in and
 * out of it by the way. */
static standoff_pose hand(double time)
{
    const double above = 0.0055 - 0.001 * sin(4.0 * time);
    const double along = fmin(time, 1.0), angle = 1.6 * fmax(time - 1.0, 0.0);
    standoff_pose pose = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    pose.position[0] = 0.04 * along + above * sin(angle);
    pose.position[2] = 0.02 + above * cos(angle);
    return pose;
}

int main(void)
{
    const standoff_pose box = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    standoff_pose ball = hand(0.0);
    standoff_pair *pair;
    standoff_state state;
    standoff_answer answer;

    check(standoff_load("probe.pair", &pair));
    check(standoff_start(pair, &box, &ball, NULL, NULL, &state, &answer));
    for (int tick = 1; tick <= TICKS; tick++) {
        ball = hand(tick * DT);
        check(standoff_step(pair, &state, &box, &ball, NULL, NULL, DT, &answer));
        if (answer.status != STANDOFF_CONVERGED && answer.status != STANDOFF_GLOBAL &&
            answer.status != STANDOFF_LOCAL) {
            fprintf(stderr, "tick %d: %s\n", tick, standoff_advice(answer.status));
            continue; /* no force without an answer */
        }
        double force = answer.distance < 0.0 ? -STIFFNESS * answer.distance : 0.0;
        if (tick % 250 == 0 || answer.switches > 0)
            printf("%4d %8.4f mm  box %s %d  force %5.2f N along (%5.2f, %5.2f, %5.2f)\n", tick,
                   1e3 * answer.distance,
                   answer.feature_a.kind == STANDOFF_FACE ? "face" : "edge",
                   answer.feature_a.index, force, answer.normal[0], answer.normal[1],
                   answer.normal[2]);
    }
    standoff_free(pair);
    return 0;
}
