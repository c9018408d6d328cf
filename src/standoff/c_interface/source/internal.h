/* What the C files of the library share; nothing of it is seen outside. */

#ifndef STANDOFF_INTERNAL_H
#define STANDOFF_INTERNAL_H

#include <stddef.h>
#include <stdint.h>

#include "layout.h" /* written by standoff.c_interface.library from the kernels' own constants */

#define UNUSED_RESULT (-1)

/* Kernels: results and errors go through pointers, and 0 is returned where all is well. */
typedef int32_t kernel_frame(int64_t *result, void **error, int64_t table, int64_t block);

/* The beginning of a file's header, behind its magic. All numbers are little-endian. */
typedef struct {
    char digest[64];   /* of the kernels' sources */
    uint64_t checksum; /* FNV-1a of all that follows it */
} file_stamp;

static inline int64_t address(const void *pointer)
{
    return (int64_t)(intptr_t)pointer;
}

/* Read a file into a header of a size, in which the lengths of its n arrays stand, and into new
 * memory: its arrays, one behind the other. Returns a code. */
int standoff_read(const char *path, const char *magic, file_stamp *header, size_t size,
                  int64_t *lengths, int n, int64_t **numbers);

/* The addresses of n arrays, each followed by how many numbers lie there. */
void standoff_tabulate(const int64_t *numbers, const int64_t *lengths, int n, int64_t *table);

/* What a kernel returned, as a code of the interface. */
int standoff_code_of(int32_t failed, int64_t done);

#endif
