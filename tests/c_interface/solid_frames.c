/* Follows two solids through the frames of a file and writes every answer: for the tests.
 *
 *   solid_frames PAIR FRAMES ANSWERS   frames of 25 numbers: poses (12 each), and what is done: 0 a
 *                                      step, 1 a start, 2 a copy of the state and a step, 3 a step
 *                                      from the copy, 4 a start in too little memory
 *   solid_frames PAIR                  the code of standoff_solids_load
 *   solid_frames PAIR OTHER            that of a step of OTHER with the state of PAIR
 */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "standoff.h"

#define N_FRAME 25
#define N_TOLD 4
#define N_ANSWER (30 + 4 * N_TOLD)

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void put(const standoff_solids *pair, const void *state,
                const standoff_solids_answer *answer, int code, double out[N_ANSWER])
{
    const double ints[] = {answer->feature_a.kind, answer->feature_a.index,
                           answer->feature_b.kind, answer->feature_b.index,
                           answer->status,         answer->certified,
                           answer->inside,         answer->single,
                           answer->minima,         answer->complete,
                           answer->evaluations,    answer->restarts,
                           answer->rebuilds,       code};
    standoff_minimum minima[N_TOLD];
    memset(out, 0, N_ANSWER * sizeof *out);
    memcpy(out, answer, 16 * sizeof(double));
    memcpy(out + 16, ints, sizeof ints);
    const int count = standoff_solids_minima(pair, state, minima, N_TOLD);
    for (int k = 0; k < count && k < N_TOLD; k++) {
        double *to = out + 30 + 4 * k;
        to[0] = minima[k].distance, to[1] = minima[k].lower_bound;
        to[2] = (double)minima[k].key, to[3] = minima[k].felt;
    }
}

static int of_another(const standoff_solids *pair, const char *path, void *state, size_t size)
{
    const standoff_pose home = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    const standoff_pose away = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 9}};
    standoff_solids_answer answer;
    standoff_solids *other = NULL;
    int code = standoff_solids_load(path, &other);
    if (code == STANDOFF_OK)
        code = standoff_solids_start(pair, &home, &away, state, size, &answer);
    if (code == STANDOFF_OK)
        code = standoff_solids_step(other, state, &home, &away, &answer);
    const int other_copy = standoff_solids_copy(other, state, state);
    const int none = standoff_solids_minima(other, state, NULL, 0);
    standoff_solids_free(other);
    return code == other_copy && none == 0 ? code : 1;
}

int main(int count, char **words)
{
    standoff_solids *pair = NULL;
    standoff_solids_answer answer;
    double frame[N_FRAME], out[N_ANSWER], spent = 0.0;
    memset(&answer, 0, sizeof answer);
    int code = standoff_solids_load(words[1], &pair);
    const size_t size = standoff_solids_state_size(pair);
    void *state = malloc(size + 1), *kept = malloc(size + 1);
    if (code == STANDOFF_OK && count == 3)
        code = of_another(pair, words[2], state, size);
    if (code != STANDOFF_OK || count < 4) {
        printf("%d %s\n", code, standoff_message(code));
        standoff_solids_free(pair);
        free(state), free(kept);
        return 0;
    }
    FILE *in = fopen(words[2], "rb"), *to = fopen(words[3], "wb");
    while (fread(frame, sizeof frame, 1, in) == 1) {
        const standoff_pose *pose_a = (const standoff_pose *)frame;
        const standoff_pose *pose_b = (const standoff_pose *)(frame + 12);
        const int asked = (int)frame[24];
        if (asked == 2)
            standoff_solids_copy(pair, state, kept);
        if (asked == 3)
            standoff_solids_copy(pair, kept, state);
        const double began = now();
        if (asked == 1)
            code = standoff_solids_start(pair, pose_a, pose_b, state, size, &answer);
        else if (asked == 4)
            code = standoff_solids_start(pair, pose_a, pose_b, state, size - 1, &answer);
        else
            code = standoff_solids_step(pair, state, pose_a, pose_b, &answer);
        spent += asked == 1 ? 0.0 : now() - began;
        put(pair, state, &answer, code, out);
        fwrite(out, sizeof out, 1, to);
    }
    fclose(in);
    fclose(to);
    standoff_solids_free(pair);
    free(state), free(kept);
    printf("%.9f\n", spent);
    return 0;
}
