// SPDX-License-Identifier: MIT
//
// studio_server.h: a studio's session over HTTP, for the page of apps/viewer. docs/studio.md lists the requests.
//
// Only this machine can connect. Every request carries a token that this run made up; the Host and Origin headers must
// be those of this server, so that no other site's page gets through, by whatever name it found us (DNS rebinding).
// Bodies are limited in size, nothing in a request names a file, and connections without the token get little time.
#pragma once

#include <functional>
#include <string>

#include "apps/alcap/studio/studio_session.h"

namespace alcap::app {

struct StudioServerOptions {
  int port = 0;                  // any that is free
  std::string title = "studio";  // of the page and of downloads
  /// Called with every request that has the token, from any thread.
  std::function<void()> opened = {};
};

/// Whether this program has the studio's server. Throws Failure(usage) that says what is missing otherwise.
void check_studio();

/// Serves until the process ends. `ready` gets the address with the token. Throws Failure when the port is taken.
void serve_studio(StudioSession& session, const StudioServerOptions& options,
                  const std::function<void(const std::string& url)>& ready);

}  // namespace alcap::app
