/* The C interface: pairs from files, and frames by the compiled kernels. See standoff.h. */

#include "standoff.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "internal.h"

_Static_assert(N_LONG_BLOCK <= STANDOFF_STATE_NUMBERS, "a state must hold a block");
_Static_assert(sizeof(double) == 8 && sizeof(void *) == 8, "kernels have 64-bit numbers");

typedef int32_t kernel_smooth(int64_t *result, void **error, int64_t record, double step);

kernel_frame standoff_kernel_start, standoff_kernel_step;
kernel_smooth standoff_kernel_predicted, standoff_kernel_paper;
#define SMOOTH_FRAME(name) kernel_smooth name;
SMOOTH_FRAMES
#undef SMOOTH_FRAME

static kernel_smooth *const smooth_frames[] = {
    NULL,
#define SMOOTH_FRAME(name) name,
    SMOOTH_FRAMES
#undef SMOOTH_FRAME
};

enum { INTS_A, REALS_A, INTS_B, REALS_B, OPTIONS, N_ARRAYS };

/* What stands at the front of a file, behind the magic. */
typedef struct {
    file_stamp stamp;
    int64_t law;    /* 0: predictor-corrector, 1: the paper's */
    int64_t smooth; /* the frame that is tried first; 0: none */
    int64_t lengths[N_ARRAYS];
    double frame_time;
    double longest_step;
} file_header;

struct standoff_pair {
    file_header header;
    int64_t table[2 * N_ARRAYS]; /* addresses, each followed by how many numbers lie there */
    int64_t *numbers;            /* all arrays, one behind the other */
};

int standoff_load(const char *path, standoff_pair **pair)
{
    if (path == NULL || pair == NULL)
        return STANDOFF_NULL;
    file_header header;
    int64_t *numbers;
    const int code = standoff_read(path, "STANDOF1", &header.stamp, sizeof header, header.lengths,
                                   N_ARRAYS, &numbers);
    if (code != STANDOFF_OK)
        return code;
    const int laws = header.law == 0 || header.law == 1;
    const int64_t frames = (int64_t)(sizeof smooth_frames / sizeof *smooth_frames);
    const int smooth = header.smooth >= 0 && header.smooth < frames;
    standoff_pair *made = malloc(sizeof *made);
    if (made == NULL || !laws || !smooth || header.lengths[OPTIONS] != N_OPTIONS) {
        const int why = made == NULL ? STANDOFF_NO_MEMORY : STANDOFF_DAMAGED;
        free(made), free(numbers);
        return why;
    }
    made->header = header;
    made->numbers = numbers;
    standoff_tabulate(numbers, header.lengths, N_ARRAYS, made->table);
    /* An option is a number; an address below 2^53 is one exactly, and the kernels read it so. */
    double *options = (double *)(intptr_t)made->table[2 * OPTIONS];
    options[O_SMOOTH] = (double)(intptr_t)smooth_frames[header.smooth];
    options[O_FRAME] = (double)(intptr_t)(header.law == 1 ? standoff_kernel_paper : standoff_kernel_predicted);
    *pair = made;
    return STANDOFF_OK;
}

void standoff_free(standoff_pair *pair)
{
    if (pair != NULL)
        free(pair->numbers);
    free(pair);
}

static const int64_t *ints_of(const standoff_pair *pair, int body)
{
    return (const int64_t *)(intptr_t)pair->table[2 * (body == 0 ? INTS_A : INTS_B)];
}

static standoff_feature feature_of(const standoff_pair *pair, int body, double number)
{
    const int64_t *ints = ints_of(pair, body);
    int64_t index = (int64_t)number;
    standoff_feature feature = {STANDOFF_FACE, -1};
    for (int kind = STANDOFF_FACE; kind <= STANDOFF_VERTEX; kind++) {
        const int64_t count = ints[N_FACES + kind];
        if (index < count) {
            feature.kind = kind;
            feature.index = (int32_t)index;
            return feature;
        }
        index -= count;
    }
    return feature;
}

int standoff_features(const standoff_pair *pair, int body, int kind)
{
    if (pair == NULL || body < 0 || body > 1 || kind < STANDOFF_FACE || kind > STANDOFF_VERTEX)
        return -1;
    return (int)ints_of(pair, body)[N_FACES + kind];
}

double standoff_frame_time(const standoff_pair *pair)
{
    return pair == NULL ? NAN : pair->header.frame_time;
}

/* Write a frame's poses, twists and time where the kernels read them. */
static void put(double *block, const standoff_pose *pose_a, const standoff_pose *pose_b,
                const standoff_twist *twist_a, const standoff_twist *twist_b, double step)
{
    double *motion = block + BLOCK_MOTION;
    memcpy(motion + POSE_A, pose_a, sizeof *pose_a);
    memcpy(motion + POSE_B, pose_b, sizeof *pose_b);
    memset(motion + TWIST_A, 0, 2 * sizeof(standoff_twist));
    if (twist_a != NULL)
        memcpy(motion + TWIST_A, twist_a, sizeof *twist_a);
    if (twist_b != NULL)
        memcpy(motion + TWIST_B, twist_b, sizeof *twist_b);
    block[BLOCK_TIME_STEP] = step;
    block[BLOCK_HAS_TWIST] = twist_a != NULL || twist_b != NULL ? 1.0 : 0.0;
}

static void tell(const standoff_pair *pair, const double *out, standoff_answer *answer)
{
    const double *counts = out + OUT_COUNTS;
    answer->distance = out[DISTANCE];
    answer->lower_bound = out[LOWER_BOUND];
    answer->upper_bound = out[UPPER_BOUND];
    memcpy(answer->point_a, out + POINT_A, sizeof answer->point_a);
    memcpy(answer->point_b, out + POINT_B, sizeof answer->point_b);
    memcpy(answer->normal, out + NORMAL, sizeof answer->normal);
    memcpy(answer->velocity_a, out + VELOCITY_A, sizeof answer->velocity_a);
    memcpy(answer->velocity_b, out + VELOCITY_B, sizeof answer->velocity_b);
    memcpy(answer->parameters_a, out + OUT_Q, sizeof answer->parameters_a);
    memcpy(answer->parameters_b, out + OUT_Q + 2, sizeof answer->parameters_b);
    answer->residual = out[RESIDUAL];
    answer->feature_a = feature_of(pair, 0, out[OUT_MODE]);
    answer->feature_b = feature_of(pair, 1, out[OUT_MODE + 2]);
    answer->status = (int32_t)out[STATUS];
    answer->certified = answer->status == STANDOFF_CONVERGED ||
                        answer->status == STANDOFF_GLOBAL || answer->status == STANDOFF_FAR;
    answer->evaluations = (int32_t)counts[EVALUATIONS];
    answer->corrections = (int32_t)counts[CORRECTIONS];
    answer->switches = (int32_t)counts[EVENTS];
    answer->restarts = (int32_t)counts[RESTARTS];
    answer->regularised = (int32_t)counts[REGULARISED];
    answer->saturations = (int32_t)counts[SATURATIONS];
    answer->searches = (int32_t)counts[SEARCHES];
    answer->general_frames = (int32_t)counts[GENERAL_FRAMES];
}

/* What a kernel returned, as a code of this interface. */
int standoff_code_of(int32_t failed, int64_t done)
{
    if (failed != 0)
        return STANDOFF_FAILED;
    switch (done) {
    case FINE:
        return STANDOFF_OK;
    case BAD_POSE_A:
        return STANDOFF_BAD_POSE_A;
    case BAD_POSE_B:
        return STANDOFF_BAD_POSE_B;
    case BAD_TWIST:
        return STANDOFF_BAD_TWIST;
    case OUT_OF_PLANE:
        return STANDOFF_OUT_OF_PLANE;
    default:
        return STANDOFF_FAILED;
    }
}

int standoff_start(const standoff_pair *pair, const standoff_pose *pose_a,
                   const standoff_pose *pose_b, const standoff_twist *twist_a,
                   const standoff_twist *twist_b, standoff_state *state, standoff_answer *answer)
{
    if (pair == NULL || pose_a == NULL || pose_b == NULL || state == NULL || answer == NULL)
        return STANDOFF_NULL;
    standoff_state made;
    memset(&made, 0, sizeof made);
    put(made.numbers, pose_a, pose_b, twist_a, twist_b, 0.0);
    int64_t done = UNUSED_RESULT;
    void *error = NULL;
    const int32_t failed =
        standoff_kernel_start(&done, &error, address(pair->table), address(made.numbers));
    const int code = standoff_code_of(failed, done);
    if (code == STANDOFF_OK) {
        made.pair = pair->header.stamp.checksum;
        *state = made;
        tell(pair, made.numbers, answer);
    }
    return code;
}

int standoff_step(const standoff_pair *pair, standoff_state *state, const standoff_pose *pose_a,
                  const standoff_pose *pose_b, const standoff_twist *twist_a,
                  const standoff_twist *twist_b, double step, standoff_answer *answer)
{
    if (pair == NULL || pose_a == NULL || pose_b == NULL || state == NULL || answer == NULL)
        return STANDOFF_NULL;
    if (state->pair != pair->header.stamp.checksum)
        return STANDOFF_OTHER_STATE;
    if (!(step > 0.0 && step <= pair->header.longest_step && isfinite(step)))
        return STANDOFF_BAD_TIME_STEP;
    put(state->numbers, pose_a, pose_b, twist_a, twist_b, step);
    int64_t done = UNUSED_RESULT;
    void *error = NULL;
    const int32_t failed =
        standoff_kernel_step(&done, &error, address(pair->table), address(state->numbers));
    const int code = standoff_code_of(failed, done);
    if (code == STANDOFF_OK)
        tell(pair, state->numbers, answer);
    return code;
}

int standoff_switches(const standoff_pair *pair, const standoff_state *state,
                      standoff_switch *switches, int room)
{
    if (pair == NULL || state == NULL || state->pair != pair->header.stamp.checksum)
        return 0;
    const double *event = state->numbers + BLOCK_EVENTS;
    const int count = (int)state->numbers[OUT_COUNTS + EVENTS];
    for (int k = 0; k < count && k < room && switches != NULL; k++, event += EVENT_COLUMNS) {
        const int body = (int)event[BODY];
        switches[k].body = body;
        switches[k].source = feature_of(pair, body, event[SOURCE]);
        switches[k].target = feature_of(pair, body, event[TARGET]);
    }
    return count;
}

/* R <- R (3 I - R'R) / 2 converges to the nearest rotation, quadratically. */
int standoff_orthonormalise(standoff_pose *pose)
{
    if (pose == NULL)
        return STANDOFF_NULL;
    double r[9], off = 0.0;
    memcpy(r, pose->rotation, sizeof r);
    for (int turn = 0; turn < 6; turn++) {
        double g[9], next[9];
        off = 0.0;
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                const double dot = r[i] * r[j] + r[3 + i] * r[3 + j] + r[6 + i] * r[6 + j];
                g[3 * i + j] = (i == j ? 3.0 : 0.0) - dot;
                off = fmax(off, fabs(dot - (i == j ? 1.0 : 0.0)));
                if (!isfinite(dot))
                    return STANDOFF_BAD_POSE_A;
            }
        if (turn == 0 && off > ROUNDED)
            return STANDOFF_BAD_POSE_A;
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                next[3 * i + j] = 0.5 * (r[3 * i] * g[j] + r[3 * i + 1] * g[3 + j] +
                                         r[3 * i + 2] * g[6 + j]);
        memcpy(r, next, sizeof r);
    }
    const double volume = r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6]) +
                          r[2] * (r[3] * r[7] - r[4] * r[6]);
    if (!(volume > 0.0))
        return STANDOFF_BAD_POSE_A;
    memcpy(pose->rotation, r, sizeof r);
    return STANDOFF_OK;
}

const char *standoff_message(int code)
{
    switch (code) {
    case STANDOFF_OK:
        return "all is well";
    case STANDOFF_BAD_POSE_A:
        return "pose A is not a pose: its rotation must be orthonormal to 1e-9 and not mirrored, "
               "and all numbers finite; standoff_orthonormalise repairs one in single precision";
    case STANDOFF_BAD_POSE_B:
        return "pose B is not a pose: its rotation must be orthonormal to 1e-9 and not mirrored, "
               "and all numbers finite; standoff_orthonormalise repairs one in single precision";
    case STANDOFF_BAD_TWIST:
        return "a twist is not finite";
    case STANDOFF_BAD_TIME_STEP:
        return "the time step must be positive, finite and, with the paper's law, no longer than "
               "the frame time that the pair was saved with";
    case STANDOFF_OUT_OF_PLANE:
        return "a planar pair turns about z and moves in x and y: a pose leaves z = 0";
    case STANDOFF_OTHER_STATE:
        return "the state was not started with this pair: call standoff_start first, of solids "
               "standoff_solids_start";
    case STANDOFF_NULL:
        return "a pointer is NULL: only twists may be";
    case STANDOFF_NO_ROOM:
        return "the state has less memory than standoff_solids_state_size tells";
    case STANDOFF_NO_FILE:
        return "the file cannot be opened or read";
    case STANDOFF_NOT_A_PAIR:
        return "the file does not hold a pair: write one with standoff.c_interface.save_pair in Python";
    case STANDOFF_DAMAGED:
        return "the file is truncated or was changed: save the pair again";
    case STANDOFF_OTHER_VERSION:
        return "the pair was saved by another version of Standoff than this library was built "
               "from: save it again, or build the library again";
    case STANDOFF_NO_MEMORY:
        return "out of memory";
    default:
        return "a fault of the library: please report it with the pair and its poses";
    }
}

const char *standoff_advice(int status)
{
    static const char *const advice[] = {STATUS_ADVICE};
    const int count = (int)(sizeof advice / sizeof *advice);
    return status >= 0 && status < count ? advice[status] : "no such status";
}

const char *standoff_version(void)
{
    return VERSION;
}
