/* A library to be loaded before all others (LD_PRELOAD): the K-th call of one kind on files below a
 * folder fails, as a full disk or a lost mount makes it.
 *   FAULT_FOLDER  the folder
 *   FAULT_KIND    write, read, open, rename or truncate; alloc: a large allocation (64 KiB or more)
 *                 of the program, wherever its bytes go; device: a call of OpenCL
 *                 (device_fault_shim.c)
 *   FAULT_AT      K, from 1 on; 0: none fails
 *   FAULT_FROM    1: all calls from the K-th on fail
 *   FAULT_ERRNO   what they say
 *   FAULT_COUNT   a file that gets the number of calls when the program ends
 */
#define _GNU_SOURCE
#include "tests/support/fault_shim.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

static atomic_long calls;
static const char *folder, *kind;
static long at;
static int from, code;
static int ready;

__attribute__((constructor)) static void begin(void) {
  folder = getenv("FAULT_FOLDER");
  kind = getenv("FAULT_KIND");
  at = getenv("FAULT_AT") != NULL ? atol(getenv("FAULT_AT")) : 0;
  from = getenv("FAULT_FROM") != NULL && atoi(getenv("FAULT_FROM")) != 0;
  code = getenv("FAULT_ERRNO") != NULL ? atoi(getenv("FAULT_ERRNO")) : EIO;
  ready = folder != NULL && kind != NULL;
}

__attribute__((destructor)) static void end(void) {
  const char* const name = getenv("FAULT_COUNT");
  ready = 0;
  if (name == NULL) return;
  FILE* const file = fopen(name, "w");
  if (file == NULL) return;
  fprintf(file, "%ld\n", (long)calls);
  fclose(file);
}

int fault_fails(void) {
  const long call = atomic_fetch_add(&calls, 1) + 1;
  if (at == 0 || (from ? call < at : call != at)) return 0;
  errno = code;
  return 1;
}

int fault_concerns(const char* what) { return ready && kind != NULL && strcmp(kind, what) == 0; }

static int is_below(const char* path) {
  return path != NULL && strncmp(path, folder, strlen(folder)) == 0;
}

static int concerns_file(const char* what, int file) {
  if (!fault_concerns(what)) return 0;
  char link[64], path[4096];
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  if (length < 0) return 0;
  path[length] = '\0';
  return is_below(path);
}

static int concerns_path(const char* what, const char* path) {
  return fault_concerns(what) && is_below(path);
}

#define NEXT(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

ssize_t write(int file, const void* bytes, size_t count) {
  return concerns_file("write", file) && fault_fails() ? -1 : NEXT(write)(file, bytes, count);
}
ssize_t writev(int file, const struct iovec* parts, int count) {
  return concerns_file("write", file) && fault_fails() ? -1 : NEXT(writev)(file, parts, count);
}
ssize_t pwrite(int file, const void* bytes, size_t count, off_t offset) {
  return concerns_file("write", file) && fault_fails() ? -1
                                                       : NEXT(pwrite)(file, bytes, count, offset);
}
ssize_t pwrite64(int file, const void* bytes, size_t count, off64_t offset) {
  return concerns_file("write", file) && fault_fails() ? -1
                                                       : NEXT(pwrite64)(file, bytes, count, offset);
}
size_t fwrite(const void* bytes, size_t size, size_t count, FILE* file) {
  return concerns_file("write", fileno(file)) && fault_fails()
             ? 0
             : NEXT(fwrite)(bytes, size, count, file);
}
ssize_t read(int file, void* bytes, size_t count) {
  return concerns_file("read", file) && fault_fails() ? -1 : NEXT(read)(file, bytes, count);
}
ssize_t pread(int file, void* bytes, size_t count, off_t offset) {
  return concerns_file("read", file) && fault_fails() ? -1
                                                      : NEXT(pread)(file, bytes, count, offset);
}
ssize_t pread64(int file, void* bytes, size_t count, off64_t offset) {
  return concerns_file("read", file) && fault_fails() ? -1
                                                      : NEXT(pread64)(file, bytes, count, offset);
}
int rename(const char* before, const char* after) {
  return concerns_path("rename", before) && fault_fails() ? -1 : NEXT(rename)(before, after);
}
int ftruncate(int file, off_t size) {
  return concerns_file("truncate", file) && fault_fails() ? -1 : NEXT(ftruncate)(file, size);
}
int ftruncate64(int file, off64_t size) {
  return concerns_file("truncate", file) && fault_fails() ? -1 : NEXT(ftruncate64)(file, size);
}
int truncate64(const char* path, off64_t size) {
  return concerns_path("truncate", path) && fault_fails() ? -1 : NEXT(truncate64)(path, size);
}
int truncate(const char* path, off_t size) {
  return concerns_path("truncate", path) && fault_fails() ? -1 : NEXT(truncate)(path, size);
}
static mode_t mode_of(int flags, va_list rest) {
  return (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0;
}
int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = mode_of(flags, rest);
  va_end(rest);
  return concerns_path("open", path) && fault_fails() ? -1 : NEXT(open)(path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = mode_of(flags, rest);
  va_end(rest);
  return concerns_path("open", path) && fault_fails() ? -1 : NEXT(open64)(path, flags, mode);
}
FILE* fopen64(const char* path, const char* mode) {
  return concerns_path("open", path) && fault_fails() ? NULL : NEXT(fopen64)(path, mode);
}
FILE* fopen(const char* path, const char* mode) {
  return concerns_path("open", path) && fault_fails() ? NULL : NEXT(fopen)(path, mode);
}

/* dlsym itself allocates: the C library's own name leads there without it. */
extern void* __libc_malloc(size_t size);
void* malloc(size_t size) {
  if (size >= 65536 && fault_concerns("alloc") && fault_fails()) {
    errno = ENOMEM;
    return NULL;
  }
  return __libc_malloc(size);
}
