/* Two solids that move: frames by the compiled kernel on the caller's memory. See standoff.h. */

#include "standoff.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "internal.h"

kernel_frame standoff_kernel_solids;

/* What stands at the front of a file, behind the magic. */
typedef struct {
    file_stamp stamp;
    int64_t lengths[SOLIDS_N_TABLED];
    double frame_time;
} solids_header;

struct standoff_solids {
    solids_header header;
    int64_t table[2 * SOLIDS_N_TABLED]; /* addresses, each followed by how many numbers lie there */
    int64_t *numbers;                   /* all arrays, one behind the other */
};

/* The caller's memory: of which pair it is, then what the kernels read. */
typedef struct {
    uint64_t pair;
    double block[];
} solids_state;

int standoff_solids_load(const char *path, standoff_solids **pair)
{
    if (path == NULL || pair == NULL)
        return STANDOFF_NULL;
    solids_header header;
    int64_t *numbers;
    const int code = standoff_read(path, "STANDOFS", &header.stamp, sizeof header, header.lengths,
                                   SOLIDS_N_TABLED, &numbers);
    if (code != STANDOFF_OK)
        return code;
    standoff_solids *made = malloc(sizeof *made);
    if (made == NULL || header.lengths[SOLIDS_T_ASKED] != SOLIDS_N_ASKED) {
        const int why = made == NULL ? STANDOFF_NO_MEMORY : STANDOFF_DAMAGED;
        free(made), free(numbers);
        return why;
    }
    made->header = header;
    made->numbers = numbers;
    standoff_tabulate(numbers, header.lengths, SOLIDS_N_TABLED, made->table);
    *pair = made;
    return STANDOFF_OK;
}

void standoff_solids_free(standoff_solids *pair)
{
    if (pair != NULL)
        free(pair->numbers);
    free(pair);
}

double standoff_solids_frame_time(const standoff_solids *pair)
{
    return pair == NULL ? NAN : pair->header.frame_time;
}

size_t standoff_solids_state_size(const standoff_solids *pair)
{
    return pair == NULL ? 0 : sizeof(solids_state) + sizeof(double) * SOLIDS_N_SOLIDS_BLOCK;
}

static int is_of(const standoff_solids *pair, const void *state)
{
    return ((const solids_state *)state)->pair == pair->header.stamp.checksum;
}

/* A leaf's feature, and parameters as it has them; nan for those of a body with a radius. */
static standoff_feature feature_of(const standoff_solids *pair, int body, double leaf,
                                   const double *values, double *parameters)
{
    const int64_t *leaves = (const int64_t *)(intptr_t)pair->table[2 * (SOLIDS_T_LEAVES_A + body)];
    const int64_t *told = leaves + 3 * (int64_t)leaf;
    const standoff_feature feature = {(int32_t)told[0], (int32_t)told[1]};
    for (int k = 0; k < 2; k++)
        parameters[k] = told[2] < 0 ? NAN : k < told[2] ? values[k] : 0.0;
    return feature;
}

static void put_minimum(const standoff_solids *pair, const double *m, standoff_minimum *to)
{
    to->distance = m[SOLIDS_M_DISTANCE];
    to->lower_bound = m[SOLIDS_M_LOWER];
    memcpy(to->point_a, m + SOLIDS_M_A, sizeof to->point_a);
    memcpy(to->point_b, m + SOLIDS_M_B, sizeof to->point_b);
    memcpy(to->normal, m + SOLIDS_M_NORMAL, sizeof to->normal);
    to->feature_a = feature_of(pair, 0, m[SOLIDS_M_LEAVES], m + SOLIDS_M_PARAMETERS,
                               to->parameters_a);
    to->feature_b = feature_of(pair, 1, m[SOLIDS_M_LEAVES + 1], m + SOLIDS_M_PARAMETERS + 2,
                               to->parameters_b);
    to->key = (int64_t)m[SOLIDS_M_KEY];
    to->felt = (int32_t)m[SOLIDS_M_FELT];
}

static void tell(const standoff_solids *pair, const double *block, standoff_solids_answer *answer)
{
    const double *out = block + SOLIDS_ANSWER;
    standoff_minimum nearest;
    memset(answer, 0, sizeof *answer);
    answer->minima = (int32_t)out[SOLIDS_A_N_MINIMA];
    if (answer->minima > 0) {
        put_minimum(pair, block + SOLIDS_MINIMA, &nearest);
        answer->distance = nearest.distance;
        memcpy(answer->point_a, nearest.point_a, sizeof answer->point_a);
        memcpy(answer->point_b, nearest.point_b, sizeof answer->point_b);
        memcpy(answer->normal, nearest.normal, sizeof answer->normal);
        memcpy(answer->parameters_a, nearest.parameters_a, sizeof answer->parameters_a);
        memcpy(answer->parameters_b, nearest.parameters_b, sizeof answer->parameters_b);
        answer->feature_a = nearest.feature_a;
        answer->feature_b = nearest.feature_b;
    } else {
        answer->distance = INFINITY;
        answer->feature_a.index = answer->feature_b.index = -1;
    }
    answer->lower_bound = out[SOLIDS_A_LOWER];
    answer->upper_bound = out[SOLIDS_A_UPPER];
    answer->status = (int32_t)out[SOLIDS_A_STATUS];
    answer->certified =
        answer->status == STANDOFF_CONVERGED || answer->status == STANDOFF_CONTAINED;
    answer->inside = (int32_t)out[SOLIDS_A_INSIDE];
    answer->single = (int32_t)out[SOLIDS_A_SINGLE];
    answer->complete = (int32_t)out[SOLIDS_A_COMPLETE];
    answer->evaluations = (int32_t)out[SOLIDS_A_EVALUATIONS];
    answer->restarts = (int32_t)out[SOLIDS_A_RESTARTS];
    answer->rebuilds = (int32_t)out[SOLIDS_A_ANEW];
}

static int frame(const standoff_solids *pair, double *block, const standoff_pose *pose_a,
                 const standoff_pose *pose_b, double fresh)
{
    int64_t done = UNUSED_RESULT;
    void *error = NULL;
    memcpy(block + SOLIDS_POSES, pose_a, sizeof *pose_a);
    memcpy(block + SOLIDS_POSES + 12, pose_b, sizeof *pose_b);
    block[SOLIDS_FRESH] = fresh;
    const int32_t failed =
        standoff_kernel_solids(&done, &error, address(pair->table), address(block));
    return standoff_code_of(failed, done);
}

int standoff_solids_start(const standoff_solids *pair, const standoff_pose *pose_a,
                          const standoff_pose *pose_b, void *state, size_t size,
                          standoff_solids_answer *answer)
{
    if (pair == NULL || pose_a == NULL || pose_b == NULL || state == NULL || answer == NULL)
        return STANDOFF_NULL;
    if (size < standoff_solids_state_size(pair))
        return STANDOFF_NO_ROOM;
    solids_state *made = state;
    const int code = frame(pair, made->block, pose_a, pose_b, 1.0);
    if (code == STANDOFF_OK) {
        made->pair = pair->header.stamp.checksum;
        tell(pair, made->block, answer);
    }
    return code;
}

int standoff_solids_step(const standoff_solids *pair, void *state, const standoff_pose *pose_a,
                         const standoff_pose *pose_b, standoff_solids_answer *answer)
{
    if (pair == NULL || pose_a == NULL || pose_b == NULL || state == NULL || answer == NULL)
        return STANDOFF_NULL;
    if (!is_of(pair, state))
        return STANDOFF_OTHER_STATE;
    double *block = ((solids_state *)state)->block;
    const int code = frame(pair, block, pose_a, pose_b, 0.0);
    if (code == STANDOFF_OK)
        tell(pair, block, answer);
    return code;
}

int standoff_solids_copy(const standoff_solids *pair, const void *from, void *to)
{
    if (pair == NULL || from == NULL || to == NULL)
        return STANDOFF_NULL;
    if (!is_of(pair, from))
        return STANDOFF_OTHER_STATE;
    const double *block = ((const solids_state *)from)->block;
    double *other = ((solids_state *)to)->block;
    const size_t number = sizeof(double);
    const size_t contact = SOLIDS_CONTACT_ROW * (size_t)block[SOLIDS_CONTACT_COUNT];
    const size_t rows = (size_t)block[SOLIDS_FRONT_COUNT];
    const int meets = block[SOLIDS_MODE] == SOLIDS_IN_CONTACT;
    ((solids_state *)to)->pair = pair->header.stamp.checksum;
    memcpy(other, block, number * (SOLIDS_FIXED + (meets ? contact : 0)));
    memcpy(other + SOLIDS_KEYS, block + SOLIDS_KEYS, number * SOLIDS_KEY_ROW * rows);
    memcpy(other + SOLIDS_ROWS, block + SOLIDS_ROWS, number * SOLIDS_FRONT_ROW * rows);
    return STANDOFF_OK;
}

int standoff_solids_minima(const standoff_solids *pair, const void *state,
                           standoff_minimum *minima, int room)
{
    if (pair == NULL || state == NULL || !is_of(pair, state))
        return 0;
    const double *block = ((const solids_state *)state)->block;
    const int count = (int)block[SOLIDS_ANSWER + SOLIDS_A_N_MINIMA];
    for (int k = 0; k < count && k < room && minima != NULL; k++)
        put_minimum(pair, block + SOLIDS_MINIMA + SOLIDS_M_REALS * k, minima + k);
    return count;
}
