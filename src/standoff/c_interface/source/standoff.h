/* Standoff: certified minimum distance of two moving convex bodies, called from C or C++.
 *
 * A pair of bodies and the law that follows them are prepared in Python, saved to a file
 * (standoff.c_interface.save_pair) and loaded here. Nothing below needs Python.
 *
 *   standoff_pair *pair;
 *   int code = standoff_load("tool_and_part.pair", &pair);
 *   if (code != STANDOFF_OK) { fputs(standoff_message(code), stderr); exit(1); }
 *   standoff_state state;
 *   standoff_answer answer;
 *   code = standoff_start(pair, &pose_a, &pose_b, NULL, NULL, &state, &answer);
 *   ... in the loop:
 *   code = standoff_step(pair, &state, &pose_a, &pose_b, NULL, NULL, 1e-3, &answer);
 *   ... at the end:
 *   standoff_free(pair);
 *
 * Units are those of the bodies (length) and seconds; all vectors are in world axes. No function
 * but standoff_load allocates memory, takes a lock or opens a file. A pair is never changed once it
 * is loaded: threads may share it, each with its own state.
 */

#ifndef STANDOFF_H
#define STANDOFF_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(_WIN32)
#define STANDOFF_API
#else
#define STANDOFF_API __attribute__((visibility("default")))
#endif

/* What a call returns. Negative: nothing was changed. */
enum standoff_code {
    STANDOFF_OK = 0,
    STANDOFF_BAD_POSE_A = -1,    /* not a rotation (to 1e-9), or not finite */
    STANDOFF_BAD_POSE_B = -2,
    STANDOFF_BAD_TWIST = -3,     /* not finite */
    STANDOFF_BAD_TIME_STEP = -4, /* not positive, or too long for the law to be stable */
    STANDOFF_OUT_OF_PLANE = -5,  /* a planar pair moves in z = 0 */
    STANDOFF_OTHER_STATE = -6,   /* the state was not started with this pair */
    STANDOFF_NULL = -7,          /* a pointer that must be given is NULL */
    STANDOFF_NO_ROOM = -8,       /* less memory than standoff_solids_state_size tells */
    STANDOFF_NO_FILE = -10,      /* cannot be opened or read */
    STANDOFF_NOT_A_PAIR = -11,   /* not a file of save_pair */
    STANDOFF_DAMAGED = -12,      /* truncated, or changed */
    STANDOFF_OTHER_VERSION = -13,/* saved for another version of this library */
    STANDOFF_NO_MEMORY = -14,
    STANDOFF_FAILED = -20        /* a fault of the library: please report it */
};

/* How an answer ended; the numbers are those of standoff.Status in Python. */
enum standoff_status {
    STANDOFF_CONVERGED = 0,     /* apart, and certified */
    STANDOFF_TRACKING = 1,      /* the law is still converging; the lower bound holds */
    STANDOFF_OVERLAPPING = 2,   /* they are proven to overlap, but no depth is proven */
    STANDOFF_NOT_CERTIFIED = 3, /* the distance is an upper bound; the lower bound holds */
    STANDOFF_LOCAL = 4,         /* overlap: moving B by depth * normal separates the bodies */
    STANDOFF_GLOBAL = 5,        /* overlap, and no direction needs less than 0.999 of it */
    STANDOFF_DEADLINE = 6,      /* the evaluations allowed for a step ran out */
    STANDOFF_NOT_RESTARTED = 7, /* restarts=False, and a search was due; the bounds hold */
    STANDOFF_FAR = 8,           /* beyond the horizon: the lower bound holds, distance is inf */
    /* Of solids alone: */
    STANDOFF_WITHIN = 10,    /* the distance is between the bounds; what is nearer is not proven */
    STANDOFF_CONTAINED = 13  /* one is inside the other; the least wall between them is certified */
};

enum standoff_kind { STANDOFF_FACE = 0, STANDOFF_EDGE = 1, STANDOFF_VERTEX = 2 };

/* The pose of a body's frame in the world: x -> rotation x + position. */
typedef struct {
    double rotation[9]; /* by rows, orthonormal to 1e-9 */
    double position[3]; /* length */
} standoff_pose;

typedef struct {
    double linear[3];  /* of the body's origin, length/s */
    double angular[3]; /* rad/s */
} standoff_twist;

typedef struct {
    int32_t kind;  /* enum standoff_kind */
    int32_t index; /* among the body's features of this kind, from 0, as in Python; -1: none */
} standoff_feature;

typedef struct {
    double distance;    /* signed: less than 0 in penetration */
    double lower_bound; /* of the true distance, certified */
    double upper_bound;
    double point_a[3]; /* the witness points */
    double point_b[3];
    double normal[3];        /* unit, from A to B */
    double velocity_a[3];    /* of the witness points, length/s; nan if no twist is given */
    double velocity_b[3];
    double parameters_a[2];  /* (u, v) of a face, (u, 0) of an edge */
    double parameters_b[2];
    double residual;         /* largest projection error */
    standoff_feature feature_a;
    standoff_feature feature_b;
    int32_t status;          /* enum standoff_status */
    int32_t certified;       /* 1: CONVERGED, or GLOBAL in penetration */
    /* What it took. */
    int32_t evaluations;
    int32_t corrections;
    int32_t switches;        /* changes of feature since the frame before */
    int32_t restarts;        /* global queries after the first */
    int32_t regularised;     /* solves whose Hessian had to be decomposed */
    int32_t saturations;
    int32_t searches;        /* searches over all directions of depth */
    int32_t general_frames;  /* 1: left to the general frame by the one for these kinds of faces */
} standoff_answer;

/* A change of a body's feature. */
typedef struct {
    int32_t body; /* 0 for A, 1 for B */
    standoff_feature source;
    standoff_feature target;
} standoff_switch;

/* Two bodies and a law. */
typedef struct standoff_pair standoff_pair;

#define STANDOFF_STATE_NUMBERS 1024

/* The warm start: a value without pointers. Copy it to return to it. */
typedef struct {
    uint64_t pair; /* of which pair */
    double numbers[STANDOFF_STATE_NUMBERS];
} standoff_state;

/* Read a pair from a file of save_pair. The file is trusted like a program: it is checked for damage,
 * not for malice. */
STANDOFF_API int standoff_load(const char *path, standoff_pair **pair);

STANDOFF_API void standoff_free(standoff_pair *pair);

/* Find the witness points anywhere, by a global query. Takes as long as a cold query: do not
 * call it in a loop. Twists may be NULL: a body without one is at rest, and if neither has one the
 * predictions come from the last two frames. */
STANDOFF_API int standoff_start(const standoff_pair *pair, const standoff_pose *pose_a,
                                const standoff_pose *pose_b, const standoff_twist *twist_a,
                                const standoff_twist *twist_b, standoff_state *state,
                                standoff_answer *answer);

/* The witness points at the poses given, a time `step` (s) after the frame before. */
STANDOFF_API int standoff_step(const standoff_pair *pair, standoff_state *state,
                               const standoff_pose *pose_a, const standoff_pose *pose_b,
                               const standoff_twist *twist_a, const standoff_twist *twist_b,
                               double step, standoff_answer *answer);

/* The switches of the last frame, at most `room` of them into `switches`; returns how many there
 * were. */
STANDOFF_API int standoff_switches(const standoff_pair *pair, const standoff_state *state,
                                   standoff_switch *switches, int room);

/* Two solids that need not be convex, as saved by save_pair with a tracker of solids. */
typedef struct standoff_solids standoff_solids;

typedef struct {
    double distance; /* signed: less than 0 where they overlap, of the deepest place that is felt */
    double lower_bound; /* of the true distance, certified; in an overlap -(a move that parts them) */
    double upper_bound; /* where they overlap no translation shorter than this parts them */
    double point_a[3];  /* the witness points */
    double point_b[3];
    double normal[3];        /* unit, from A to B; 0 where the points are one */
    double parameters_a[2];  /* (u, v) of a face, (u, 0) of an edge; nan of a body with a radius */
    double parameters_b[2];
    standoff_feature feature_a; /* with index -1 where no pair of points was found */
    standoff_feature feature_b;
    int32_t status;      /* CONVERGED, CONTAINED, OVERLAPPING, WITHIN or DEADLINE */
    int32_t certified;   /* 1: CONVERGED or CONTAINED */
    int32_t inside;      /* 1: A is inside B's material, 2: B inside A's, 0: neither */
    int32_t single;      /* 1: the nearest points are the only ones; 0: not known to be */
    int32_t minima;      /* how many standoff_solids_minima tells */
    int32_t complete;    /* 1: these are all local minima that were asked */
    int32_t evaluations; /* of points and bounds */
    int32_t restarts;    /* 1: the frame began from nothing */
    int32_t rebuilds;    /* 1: all bounds were made anew */
} standoff_solids_answer;

/* A local minimum of the signed distance. */
typedef struct {
    double distance;
    double lower_bound;
    double point_a[3];
    double point_b[3];
    double normal[3];
    double parameters_a[2];
    double parameters_b[2];
    standoff_feature feature_a;
    standoff_feature feature_b;
    int64_t key;  /* the same from frame to frame; -1: none, as the pair was saved without minima= */
    int32_t felt; /* 0: another way out of an overlap that is felt elsewhere */
} standoff_minimum;

/* As standoff_load and standoff_free. */
STANDOFF_API int standoff_solids_load(const char *path, standoff_solids **pair);
STANDOFF_API void standoff_solids_free(standoff_solids *pair);

/* The frame time, s, that the solids were saved with; no answer depends on it. */
STANDOFF_API double standoff_solids_frame_time(const standoff_solids *pair);

/* Bytes of a state, which the caller allocates, aligned as malloc does. */
STANDOFF_API size_t standoff_solids_state_size(const standoff_solids *pair);

/* Begin anywhere, in memory of `size` bytes. Takes as long as a cold query. */
STANDOFF_API int standoff_solids_start(const standoff_solids *pair, const standoff_pose *pose_a,
                                       const standoff_pose *pose_b, void *state, size_t size,
                                       standoff_solids_answer *answer);

/* The answer at the poses given, from the frame before. */
STANDOFF_API int standoff_solids_step(const standoff_solids *pair, void *state,
                                      const standoff_pose *pose_a, const standoff_pose *pose_b,
                                      standoff_solids_answer *answer);

/* Copy what is in use of a state to other memory of the same size, to return to it; memcpy of all
 * of it does the same. */
STANDOFF_API int standoff_solids_copy(const standoff_solids *pair, const void *from, void *to);

/* The local minima of the last frame, at most `room` of them into `minima`, the answer's own first;
 * returns how many there are: one where the pair was saved without minima=. */
STANDOFF_API int standoff_solids_minima(const standoff_solids *pair, const void *state,
                                        standoff_minimum *minima, int room);

/* How many features of a kind a body (0: A, 1: B) has; -1 if there is no such body or kind. */
STANDOFF_API int standoff_features(const standoff_pair *pair, int body, int kind);

/* The frame time, s, that the pair was saved with. */
STANDOFF_API double standoff_frame_time(const standoff_pair *pair);

/* Replace a rotation that is off by rounding, as in single precision (up to 1e-5), by the nearest
 * one. Returns STANDOFF_OK, or, with nothing changed, STANDOFF_BAD_POSE_A if it is farther off. */
STANDOFF_API int standoff_orthonormalise(standoff_pose *pose);

/* What a code means and what to do, in one sentence. */
STANDOFF_API const char *standoff_message(int code);

/* What a status means and what to do, in one sentence. */
STANDOFF_API const char *standoff_advice(int status);

/* Of Standoff, such as "1.4.0". */
STANDOFF_API const char *standoff_version(void);

#ifdef __cplusplus
}
#endif

#endif
