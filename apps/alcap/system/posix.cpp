// SPDX-License-Identifier: MIT
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <string_view>
#include <system_error>
#include <thread>

#include "apps/alcap/system/system.h"

namespace alcap::app {
namespace {

volatile std::sig_atomic_t stop_signal = 0;

constexpr std::array held_signals{SIGPIPE, SIGXFSZ, SIGINT,  SIGTERM, SIGHUP,    SIGQUIT,
                                  SIGXCPU, SIGALRM, SIGUSR1, SIGUSR2, SIGVTALRM, SIGPROF};

}  // namespace

bool stderr_is_terminal() {
  if (::isatty(STDERR_FILENO) == 0) return false;
  const char* term = std::getenv("TERM");
  return term != nullptr && std::string_view(term) != "dumb";
}

void reserve_standard_streams() {
  for (int descriptor = 0; descriptor < 3; ++descriptor) {
    if (::fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF) continue;
    if (::open("/dev/null", descriptor == 0 ? O_WRONLY : O_RDONLY) != descriptor) return;
  }
}

void one_thread_for_blas() {
  using Set = void (*)(int);
  if (void* const found = dlsym(RTLD_DEFAULT, "openblas_set_num_threads")) reinterpret_cast<Set>(found)(1);
}

bool may_write_into(const std::filesystem::path& folder) { return ::access(folder.c_str(), W_OK | X_OK) == 0; }

AddressSpace address_space() {
  rlimit limit = {};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return {};
  std::int64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;  // where the system tells
  return {static_cast<std::int64_t>(limit.rlim_cur), pages * ::sysconf(_SC_PAGESIZE)};
}

void take_blas_buffer() {
  using Potrf = void (*)(const char*, const int*, double*, const int*, int*);
  void* const found = dlsym(RTLD_DEFAULT, "dpotrf_");
  if (found == nullptr) return;
  const int one = 1;
  int info = 0;
  double matrix = 1;
  reinterpret_cast<Potrf>(found)("U", &one, &matrix, &one, &info);
}

struct HeldSignals::Before {
  std::array<struct sigaction, held_signals.size()> actions{};
};

HeldSignals::HeldSignals() : before_(std::make_unique<Before>()) {
  for (std::size_t k = 0; k < held_signals.size(); ++k) {
    ::sigaction(held_signals[k], nullptr, &before_->actions[k]);
    if (before_->actions[k].sa_handler == SIG_IGN) continue;
    struct sigaction hold = {};
    if (held_signals[k] == SIGPIPE || held_signals[k] == SIGXFSZ)
      hold.sa_handler = SIG_IGN;
    else
      hold.sa_handler = [](int) { stop_signal = 1; };
    ::sigaction(held_signals[k], &hold, nullptr);
  }
}

HeldSignals::~HeldSignals() {
  for (std::size_t k = 0; k < held_signals.size(); ++k) ::sigaction(held_signals[k], &before_->actions[k], nullptr);
}

bool HeldSignals::stop_requested() { return stop_signal != 0; }

NewFolder::~NewFolder() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

bool NewFolder::make(const std::filesystem::path& path) {
  if (::mkdir(path.c_str(), 0777) != 0) {
    if (errno == EEXIST) return false;
    throw std::system_error(errno, std::generic_category());
  }
  do descriptor_ = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  while (descriptor_ < 0 && errno == EINTR);
  if (descriptor_ >= 0) (void)::flock(descriptor_, LOCK_EX | LOCK_NB);
  return true;
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

bool FolderLock::take(const std::filesystem::path& folder, std::chrono::milliseconds limit) {
  constexpr std::chrono::milliseconds pause(10);
  do descriptor_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  while (descriptor_ < 0 && errno == EINTR);
  for (auto waited = pause.zero(); descriptor_ >= 0; waited += pause) {
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || (errno != EWOULDBLOCK && errno != EINTR)) break;
    if (waited >= limit || HeldSignals::stop_requested()) return false;
    std::this_thread::sleep_for(pause);
  }
  return true;
}

}  // namespace alcap::app
