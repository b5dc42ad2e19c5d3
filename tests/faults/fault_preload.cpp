// SPDX-License-Identifier: MIT
//
// fault_preload.cpp: a library to be loaded before all others (LD_PRELOAD), in which one call of the C library goes
// wrong.
//
//   ALCAP_FAULT=CALL:K:WHAT   the K-th CALL (from 0) after the start of main; with K+ that and all that follow.
//     CALL   write, read, fsync, rename, mkdir, open, close; any: all of these, counted together; malloc
//     WHAT   an error (ENOSPC, EIO, EINTR, EDQUOT, EMFILE), short: at most one byte, kill: SIGKILL before the call
//   ALCAP_FAULT_MARK=FILE     is created when the fault happens, so that one can count up until it no longer does.
#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdlib>
#include <cstring>

#include "tests/support/libc_allocator.h"

namespace {

enum What { nothing, fails, shorter, dies };

// Read once, before main, without memory from malloc. NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables)
std::atomic<bool> running{false};
std::atomic<long> count{0};
long first = 0;
bool onwards = false;
const char* call = "";
std::size_t call_length = 0;
What what = nothing;
int error = 0;
const char* mark = nullptr;
// NOLINTEND

struct Error {
  const char* name;
  int number;
};
constexpr Error errors[] = {{"ENOSPC", ENOSPC}, {"EIO", EIO},       {"EINTR", EINTR},
                            {"EDQUOT", EDQUOT}, {"EMFILE", EMFILE}, {"ENOMEM", ENOMEM}};

void read_plan() {
  const char* const plan = std::getenv("ALCAP_FAULT");
  mark = std::getenv("ALCAP_FAULT_MARK");
  if (plan == nullptr) return;
  const char* const colon = std::strchr(plan, ':');
  if (colon == nullptr) return;
  call = plan;
  call_length = static_cast<std::size_t>(colon - plan);
  char* end = nullptr;
  first = std::strtol(colon + 1, &end, 10);
  onwards = *end == '+';
  const char* const kind = std::strchr(end, ':') == nullptr ? "" : std::strchr(end, ':') + 1;
  if (std::strcmp(kind, "short") == 0) what = shorter;
  if (std::strcmp(kind, "kill") == 0) what = dies;
  for (const Error& e : errors) {
    if (std::strcmp(kind, e.name) != 0) continue;
    what = fails;
    error = e.number;
  }
}

bool named(const char* name) { return std::strlen(name) == call_length && std::strncmp(call, name, call_length) == 0; }

/// What becomes of this call of `name`.
What fate(const char* name, bool file) {
  if (!running || what == nothing || !(named(name) || (file && named("any")))) return nothing;
  const long k = count++;
  if (k != first && !(onwards && k > first)) return nothing;
  if (mark != nullptr) {
    const long made = ::syscall(SYS_openat, AT_FDCWD, mark, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (made >= 0) ::syscall(SYS_close, made);
  }
  if (what == dies) ::kill(::getpid(), SIGKILL);
  if (what == fails) errno = error;
  return what;
}

template <class Function>
Function real(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

using Main = int (*)(int, char**, char**);
Main real_main = nullptr;  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)

int counted_main(int argc, char** argv, char** environment) {
  read_plan();
  running = true;
  const int code = real_main(argc, argv, environment);
  running = false;
  return code;
}

}  // namespace

extern "C" {
// NOLINTBEGIN: the C library's own names.
void* malloc(std::size_t size) { return fate("malloc", false) == fails ? nullptr : __libc_malloc(size); }
void* calloc(std::size_t n, std::size_t size) {
  return fate("malloc", false) == fails ? nullptr : __libc_calloc(n, size);
}
void* realloc(void* block, std::size_t size) {
  return size != 0 && fate("malloc", false) == fails ? nullptr : __libc_realloc(block, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return fate("malloc", false) == fails ? nullptr : __libc_memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  *out = aligned_alloc(alignment, size);
  return *out == nullptr ? ENOMEM : 0;
}

ssize_t write(int file, const void* bytes, std::size_t size) {
  static const auto next = real<ssize_t (*)(int, const void*, std::size_t)>("write");
  const What w = fate("write", true);
  if (w == fails) return -1;
  return next(file, bytes, w == shorter && size > 1 ? 1 : size);
}
ssize_t read(int file, void* bytes, std::size_t size) {
  static const auto next = real<ssize_t (*)(int, void*, std::size_t)>("read");
  const What w = fate("read", true);
  if (w == fails) return -1;
  return next(file, bytes, w == shorter && size > 1 ? 1 : size);
}
int fsync(int file) {
  static const auto next = real<int (*)(int)>("fsync");
  return fate("fsync", true) == fails ? -1 : next(file);
}
int rename(const char* from, const char* to) {
  static const auto next = real<int (*)(const char*, const char*)>("rename");
  return fate("rename", true) == fails ? -1 : next(from, to);
}
int mkdir(const char* path, mode_t mode) {
  static const auto next = real<int (*)(const char*, mode_t)>("mkdir");
  return fate("mkdir", true) == fails ? -1 : next(path, mode);
}
int close(int file) {
  static const auto next = real<int (*)(int)>("close");
  // The descriptor is gone in any case, as on Linux.
  const What w = fate("close", true);
  const int code = next(file);
  if (w == fails) errno = error;
  return w == fails ? -1 : code;
}
int open(const char* path, int flags, ...) {
  static const auto next = real<int (*)(const char*, int, ...)>("open");
  va_list more;
  va_start(more, flags);
  const mode_t mode = (flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE ? va_arg(more, mode_t) : 0;
  va_end(more);
  return fate("open", true) == fails ? -1 : next(path, flags, mode);
}

int __libc_start_main(Main main, int argc, char** argv, void (*init)(), void (*fini)(), void (*rtld_fini)(),
                      void* stack_end) {
  real_main = main;
  const auto next = real<int (*)(Main, int, char**, void (*)(), void (*)(), void (*)(), void*)>("__libc_start_main");
  return next(counted_main, argc, argv, init, fini, rtld_fini, stack_end);
}
// NOLINTEND
}
