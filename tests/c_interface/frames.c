/* Follows a pair through the frames of a file and writes every answer: for the tests.
 *
 *   frames PAIR FRAMES ANSWERS     frames of 38 numbers: poses (12 each), twists (6 each), has
 *                                  twists, time step; the first one starts
 *   frames PAIR                    the code of standoff_load
 */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "standoff.h"

#define N_FRAME 38
#define N_ANSWER 32

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void put(const standoff_answer *answer, int code, double out[N_ANSWER])
{
    const double ints[] = {code,
                           answer->feature_a.kind,
                           answer->feature_a.index,
                           answer->feature_b.kind,
                           answer->feature_b.index,
                           answer->status,
                           answer->evaluations,
                           answer->switches,
                           answer->general_frames};
    memcpy(out, answer, 23 * sizeof(double));
    memcpy(out + 23, ints, sizeof ints);
}

int main(int count, char **words)
{
    standoff_pair *pair = NULL;
    standoff_state state;
    standoff_answer answer;
    double frame[N_FRAME], out[N_ANSWER], spent = 0.0;
    int code = standoff_load(words[1], &pair);
    if (code != STANDOFF_OK || count < 4) {
        printf("%d %s\n", code, standoff_message(code));
        standoff_free(pair);
        return 0;
    }
    FILE *in = fopen(words[2], "rb"), *to = fopen(words[3], "wb");
    for (long k = 0; fread(frame, sizeof frame, 1, in) == 1; k++) {
        const standoff_pose *pose_a = (const standoff_pose *)frame;
        const standoff_pose *pose_b = (const standoff_pose *)(frame + 12);
        const standoff_twist *a = frame[36] != 0.0 ? (const standoff_twist *)(frame + 24) : NULL;
        const standoff_twist *b = frame[36] != 0.0 ? (const standoff_twist *)(frame + 30) : NULL;
        const double began = now();
        if (k == 0)
            code = standoff_start(pair, pose_a, pose_b, a, b, &state, &answer);
        else
            code = standoff_step(pair, &state, pose_a, pose_b, a, b, frame[37], &answer);
        spent += k == 0 ? 0.0 : now() - began;
        put(&answer, code, out);
        fwrite(out, sizeof out, 1, to);
    }
    fclose(in);
    fclose(to);
    standoff_free(pair);
    printf("%.9f\n", spent);
    return 0;
}
