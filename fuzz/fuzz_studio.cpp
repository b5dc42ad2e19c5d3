// SPDX-License-Identifier: MIT
//
// Any request, with the token and without, gets an answer from the studio, which lives on with a design that can be
// read. A quarter of them are raw bytes; the others have the form of a request.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <condition_variable>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>

#include "alcap/design_file.h"
#include "apps/alcap/studio/studio_server.h"
#include "fuzz/input.h"

namespace {

using namespace alcap;

/// A studio on an icosphere, served from a thread that lasts as long as the process.
class Studio {
 public:
  Studio() {
    std::string name = (std::filesystem::temp_directory_path() / "alcap-fuzz-XXXXXX").string();
    fuzz::demand(::mkdtemp(name.data()) != nullptr, "there is a temporary folder");
    file_ = std::filesystem::path(name) / "a.design.json";
    const MeshData m = icosphere(1);
    session_ =
        std::make_unique<app::StudioSession>(Surface(m.V, m.F), parse_design(R"({"alcap_design":1,"n":4})"), file_);
    std::thread([this] {
      app::serve_studio(*session_, {.title = "fuzz"}, [this](const std::string& url) {
        const std::lock_guard lock(mutex_);
        url_ = url;
        ready_.notify_all();
      });
    }).detach();
    std::unique_lock lock(mutex_);
    ready_.wait(lock, [&] { return !url_.empty(); });
    const std::size_t colon = url_.rfind(':');
    port_ = std::stoi(url_.substr(colon + 1));
    token_ = url_.substr(url_.find("t=") + 2);
  }
  [[nodiscard]] const std::string& token() const { return token_; }
  [[nodiscard]] std::string host() const { return "127.0.0.1:" + std::to_string(port_); }
  [[nodiscard]] DesignFile design() const { return session_->state().design; }

  /// Sends bytes on a connection of their own and returns the answer.
  [[nodiscard]] std::string ask(std::string_view bytes) const {
    const int descriptor = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port_));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    fuzz::demand(::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0,
                 "the studio takes connections");
    while (!bytes.empty()) {
      const ssize_t sent = ::send(descriptor, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) break;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    ::shutdown(descriptor, SHUT_WR);
    std::string answer;
    std::array<char, 4096> some{};
    for (ssize_t got = 0; (got = ::recv(descriptor, some.data(), some.size(), 0)) > 0;)
      if (answer.size() < 65536) answer.append(some.data(), static_cast<std::size_t>(got));
    ::close(descriptor);
    return answer;
  }

 private:
  std::filesystem::path file_;
  std::unique_ptr<app::StudioSession> session_;
  std::mutex mutex_;
  std::condition_variable ready_;
  std::string url_, token_;
  int port_ = 0;
};

std::string request(fuzz::Bytes& in, const Studio& studio, std::string_view rest) {
  static constexpr std::array targets{"POST /api/edit",  "POST /api/undo",       "POST /api/redo",
                                      "GET /api/state",  "GET /api/details",     "GET /api/design",
                                      "GET /api/export", "GET /api/mesh",        "GET /",
                                      "PUT /api/edit",   "GET /api/../api/state"};
  static constexpr std::array formats{"ply", "vtp", "rawfield", "vertex.rawfield", "rosy", "exe", "../x"};
  std::string text = targets[static_cast<std::size_t>(in.below(static_cast<int>(targets.size())))];
  text += "?t=" + (in.below(8) == 0 ? "0123" : studio.token());
  if (in.below(2) == 0) text += "&have=" + std::to_string(in.below(9));
  if (in.below(2) == 0) text += "&base=" + std::to_string(in.below(9) - 1);
  if (in.below(2) == 0) text += "&part=" + std::to_string(in.below(3));
  if (in.below(2) == 0) text += std::string("&format=") + formats[static_cast<std::size_t>(in.below(7))];
  if (in.below(4) == 0) text += "&gesture=g";
  text += " HTTP/1.1\r\nHost: " + (in.below(8) == 0 ? "other" : studio.host());
  if (in.below(8) == 0) text += "\r\nHost: " + studio.host();
  if (in.below(8) == 0) text += "\r\nOrigin: http://other";
  text += "\r\nConnection: close\r\nContent-Length: " + std::to_string(rest.size() + (in.below(8) == 0 ? 1 : 0)) +
          "\r\n\r\n";
  return text.append(rest);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Studio& studio = *new Studio;  // its thread may outlive main
  constexpr std::size_t head = 32;
  fuzz::Bytes in(data, std::min(size, head));
  const std::string_view rest(reinterpret_cast<const char*>(data) + std::min(size, head), size - std::min(size, head));
  if (in.below(4) == 3) {
    (void)studio.ask(rest);
  } else {
    const std::string answer = studio.ask(request(in, studio, rest));
    fuzz::demand(answer.empty() || answer.starts_with("HTTP/1."), "an answer is HTTP");
  }
  const std::string text = design_text(studio.design());
  fuzz::demand(design_text(parse_design(text)) == text, "the design can be read");
  return 0;
}
