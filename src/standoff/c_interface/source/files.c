/* Files of pairs: read whole, and checked. */

#include "standoff.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "internal.h"

#define N_MAGIC 8

static uint64_t fnv1a(const unsigned char *bytes, size_t count)
{
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    for (size_t k = 0; k < count; k++)
        hash = (hash ^ bytes[k]) * UINT64_C(0x100000001b3);
    return hash;
}

/* The whole content of a file; NULL, and why in `code`, where it cannot be read. */
static unsigned char *content_of(const char *path, size_t *count, int *code)
{
    FILE *file = fopen(path, "rb");
    unsigned char *bytes = NULL;
    long size = -1;
    *code = STANDOFF_NO_FILE;
    if (file == NULL)
        return NULL;
    if (fseek(file, 0, SEEK_END) == 0 && (size = ftell(file)) >= 0 && size < LONG_MAX &&
        fseek(file, 0, SEEK_SET) == 0) {
        bytes = malloc((size_t)size + 1);
        if (bytes == NULL)
            *code = STANDOFF_NO_MEMORY;
        else if (fread(bytes, 1, (size_t)size, file) != (size_t)size) {
            free(bytes);
            bytes = NULL;
        }
    }
    fclose(file);
    *count = bytes == NULL ? 0 : (size_t)size;
    return bytes;
}

/* Is the content that of a file with this magic for this library, whole and unchanged? */
static int checked(const unsigned char *bytes, size_t count, const char *magic, file_stamp *header,
                   size_t size, const int64_t *lengths, int n)
{
    if (count < N_MAGIC || memcmp(bytes, magic, N_MAGIC) != 0)
        return STANDOFF_NOT_A_PAIR;
    if (count < N_MAGIC + size)
        return STANDOFF_DAMAGED;
    memcpy(header, bytes + N_MAGIC, size);
    if (memcmp(header->digest, KERNELS_DIGEST, sizeof header->digest) != 0)
        return STANDOFF_OTHER_VERSION;
    const size_t from = N_MAGIC + sizeof *header;
    if (fnv1a(bytes + from, count - from) != header->checksum)
        return STANDOFF_DAMAGED;
    size_t left = (count - N_MAGIC - size) / 8;
    for (int k = 0; k < n; k++) {
        if (lengths[k] < 0 || (uint64_t)lengths[k] > left)
            return STANDOFF_DAMAGED;
        left -= (size_t)lengths[k];
    }
    return (count - N_MAGIC - size) % 8 == 0 && left == 0 ? STANDOFF_OK : STANDOFF_DAMAGED;
}

int standoff_read(const char *path, const char *magic, file_stamp *header, size_t size,
                  int64_t *lengths, int n, int64_t **numbers)
{
    int code;
    size_t count;
    unsigned char *bytes = content_of(path, &count, &code);
    if (bytes == NULL)
        return code;
    code = checked(bytes, count, magic, header, size, lengths, n);
    if (code == STANDOFF_OK) {
        const size_t rest = count - N_MAGIC - size;
        *numbers = malloc(rest > 0 ? rest : 1);
        if (*numbers == NULL)
            code = STANDOFF_NO_MEMORY;
        else
            memcpy(*numbers, bytes + N_MAGIC + size, rest);
    }
    free(bytes);
    return code;
}

void standoff_tabulate(const int64_t *numbers, const int64_t *lengths, int n, int64_t *table)
{
    for (int k = 0; k < n; k++) {
        table[2 * k] = address(numbers);
        table[2 * k + 1] = lengths[k];
        numbers += lengths[k];
    }
}
