// To be preloaded. Reading the file READ_FAULT_PATH fails after READ_FAULT_BYTES bytes in all, however often it is opened. With
// READ_FAULT_LOCKS there are no locks.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static long long taken;

ssize_t read(int fd, void* to, size_t room) {
  static ssize_t (*real)(int, void*, size_t);
  if (!real) real = (ssize_t(*)(int, void*, size_t))dlsym(RTLD_NEXT, "read");
  const char *path = getenv("READ_FAULT_PATH"), *bytes = getenv("READ_FAULT_BYTES");
  char link[64], name[4096];
  snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  const ssize_t length = readlink(link, name, sizeof name - 1);
  if (!path || !bytes || length < 0) return real(fd, to, room);
  name[length] = 0;
  if (strcmp(name, path) != 0) return real(fd, to, room);
  const long long left = atoll(bytes) - taken;
  if (left <= 0) {
    errno = EIO;
    return -1;
  }
  const ssize_t got = real(fd, to, room < (size_t)left ? room : (size_t)left);
  if (got > 0) taken += got;
  return got;
}

int flock(int fd, int operation) {
  static int (*real)(int, int);
  if (!real) real = (int (*)(int, int))dlsym(RTLD_NEXT, "flock");
  if (!getenv("READ_FAULT_LOCKS")) return real(fd, operation);
  errno = ENOSYS;
  return -1;
}
