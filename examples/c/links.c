/* A link of a chain is pulled until it hangs in the other one, and let go.
 *
 *   python save_links.py
 *   standoff c-library build
 *   cc links.c -Ibuild -Lbuild -lstandoff -lm -Wl,-rpath,'$ORIGIN/build' -o links
 *   ./links
 */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "standoff.h"

#define TICKS 1000

static void check(int code)
{
    if (code != STANDOFF_OK) {
        fprintf(stderr, "standoff: %s\n", standoff_message(code));
        exit(1);
    }
}

/* Where the second link is, turned by a quarter about x. */
static standoff_pose pulled(int tick)
{
    const double angle = 6.283185307179586 * tick / TICKS;
    standoff_pose pose = {{1, 0, 0, 0, 0, -1, 0, 1, 0}, {0, 0.001, 0}};
    pose.position[0] = 0.8 + 0.403 * (1.0 - cos(angle));
    return pose;
}

int main(void)
{
    const standoff_pose fixed = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    standoff_pose link = pulled(0);
    standoff_solids *pair;
    standoff_solids_answer answer;

    check(standoff_solids_load("links.pair", &pair));
    const size_t size = standoff_solids_state_size(pair);
    void *state = malloc(size);
    if (state == NULL)
        check(STANDOFF_NO_MEMORY);
    check(standoff_solids_start(pair, &fixed, &link, state, size, &answer));
    for (int tick = 1; tick <= TICKS; tick++) {
        link = pulled(tick);
        check(standoff_solids_step(pair, state, &fixed, &link, &answer));
        if (!answer.certified && answer.status != STANDOFF_OVERLAPPING) {
            fprintf(stderr, "tick %d: %s\n", tick, standoff_advice(answer.status));
            continue;
        }
        if (tick % 125 == 0)
            printf("%4d  %9.6f  %s\n", tick, answer.distance,
                   answer.certified ? "apart, certified" : "overlap");
    }
    free(state);
    standoff_solids_free(pair);
    return 0;
}
