// SPDX-License-Identifier: MIT
//
// connection_guard.h: connections that have not shown the token get little time and few threads. The HTTP library gives
// every connection a thread and as much time as it likes for its request, so that a few hundred slow ones would keep
// the studio from its own page.
#pragma once

#include <condition_variable>
#include <mutex>
#include <set>
#include <thread>

namespace alcap::app {

class ConnectionGuard {
 public:
  /// Looks after the connections to this port of this process, from a thread of its own.
  explicit ConnectionGuard(int port);
  ConnectionGuard(const ConnectionGuard&) = delete;
  ConnectionGuard& operator=(const ConnectionGuard&) = delete;
  ~ConnectionGuard();

  /// The connection from this port has shown the token.
  void trust(int remote_port);

 private:
  void watch();

  int port_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stop_ = false;
  std::set<int> trusted_;  // remote ports
  std::thread thread_;
};

}  // namespace alcap::app
