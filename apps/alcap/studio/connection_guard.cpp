// SPDX-License-Identifier: MIT
#include "apps/alcap/studio/connection_guard.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <numeric>
#include <system_error>
#include <vector>

namespace alcap::app {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto patience = std::chrono::seconds(5);      // for a request with its token; ours take milliseconds
constexpr auto period = std::chrono::milliseconds(50);  // between two looks while somebody is unknown
constexpr auto calm = std::chrono::milliseconds(250);   // and while nobody is
constexpr std::size_t most_unknown = 24;                // beyond, the oldest go at once

int port_of(int descriptor, int (*ask)(int, sockaddr*, socklen_t*)) {
  sockaddr_in address = {};
  socklen_t size = sizeof address;
  if (ask(descriptor, reinterpret_cast<sockaddr*>(&address), &size) != 0 || address.sin_family != AF_INET) return -1;
  return ntohs(address.sin_port);
}

/// Numbers of what this process has open; where the system does not list them, all that they can be within reason.
std::vector<int> open_descriptors() {
  std::vector<int> list;
  std::error_code error;
  for (std::filesystem::directory_iterator k("/dev/fd", error), end; !error && k != end; k.increment(error))
    list.push_back(std::atoi(k->path().filename().c_str()));
  if (!list.empty()) return list;
  rlimit limit = {};
  constexpr rlim_t most = 4096;
  const bool told = ::getrlimit(RLIMIT_NOFILE, &limit) == 0;
  list.resize(told ? std::min(limit.rlim_cur, most) : most);
  std::iota(list.begin(), list.end(), 0);
  return list;
}

}  // namespace

ConnectionGuard::ConnectionGuard(int port) : port_(port), thread_([this] { watch(); }) {}

ConnectionGuard::~ConnectionGuard() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void ConnectionGuard::trust(int remote_port) {
  const std::lock_guard lock(mutex_);
  trusted_.insert(remote_port);
}

void ConnectionGuard::watch() {
  struct Seen {
    int descriptor;
    Clock::time_point since;
  };
  std::map<int, Seen> unknown;  // by remote port
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, unknown.empty() ? calm : period, [this] { return stop_; })) {
    std::map<int, Seen> now;
    std::set<int> open;
    for (const int descriptor : open_descriptors()) {
      if (port_of(descriptor, ::getsockname) != port_) continue;
      const int remote = port_of(descriptor, ::getpeername);
      if (remote < 0) continue;  // the one that listens
      open.insert(remote);
      if (trusted_.contains(remote)) continue;
      const auto before = unknown.find(remote);
      now[remote] = {descriptor, before == unknown.end() ? Clock::now() : before->second.since};
    }
    std::erase_if(trusted_, [&](int remote) { return !open.contains(remote); });
    std::vector<std::pair<Clock::time_point, int>> oldest;
    for (const auto& [remote, seen] : now) oldest.emplace_back(seen.since, seen.descriptor);
    std::sort(oldest.begin(), oldest.end());
    for (std::size_t k = 0; k < oldest.size(); ++k) {
      const bool too_many = oldest.size() - k > most_unknown;
      if (too_many || Clock::now() - oldest[k].first > patience) (void)::shutdown(oldest[k].second, SHUT_RDWR);
    }
    unknown = std::move(now);
  }
}

}  // namespace alcap::app
