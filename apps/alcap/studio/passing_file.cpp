// SPDX-License-Identifier: MIT
#include "apps/alcap/studio/passing_file.h"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <string>

namespace alcap::app {

// Where a signal's handler finds names: it must not allocate, nor read what another thread frees.
struct PassingFile::Place {
  std::atomic<bool> taken{false}, there{false};
  std::array<char, 4096> name{};

  void remove() {
    if (!there) return;
    ::unlink(name.data());  // before anybody believes that it is gone: a signal may come in between
    there = false;
  }
};

std::array<PassingFile::Place, 4> PassingFile::places;

bool PassingFile::hold(const std::filesystem::path& file) {
  const std::string name = std::filesystem::absolute(file).string();
  for (Place& place : places) {
    if (name.size() >= place.name.size() || place.taken.exchange(true)) continue;
    std::copy(name.c_str(), name.c_str() + name.size() + 1, place.name.begin());
    place.there = true;
    place_ = &place;
    return true;
  }
  return false;
}

void PassingFile::remove() {
  Place* const place = place_.exchange(nullptr);
  if (place == nullptr) return;
  place->remove();
  place->taken = false;
}

void remove_passing_files_at_signals() {
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
    struct sigaction before = {}, act = {};
    ::sigaction(number, nullptr, &before);
    if (before.sa_handler == SIG_IGN) continue;
    act.sa_handler = [](int signal_number) {
      for (PassingFile::Place& place : PassingFile::places) place.remove();
      ::raise(signal_number);  // as it would have ended: the handler is gone by now
    };
    act.sa_flags = SA_RESETHAND | SA_NODEFER;
    ::sigaction(number, &act, nullptr);
  }
}

}  // namespace alcap::app
