// SPDX-License-Identifier: MIT
//
// studio_server.cpp: requests and answers. Compiled with cpp-httplib where it is installed.
#include "apps/alcap/studio/studio_server.h"

#include <fmt/core.h>

#ifdef ALCAP_WITH_HTTPLIB
#include <httplib.h>

#include <array>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <optional>
#include <random>

#include "alcap/memory.h"
#include "alcap/output.h"
#include "apps/alcap/page/html_page.h"
#include "apps/alcap/report/report.h"
#include "apps/alcap/studio/connection_guard.h"

namespace alcap::app {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t largest_body = std::size_t{8} << 20;  // a design of 10,000 strokes
constexpr std::size_t threads = 64;                         // a waiting tab holds one, an unknown connection too
constexpr auto read_timeout = std::chrono::seconds(5);      // between two bytes of a request
constexpr auto longest_wait = std::chrono::seconds(20);
constexpr std::uint64_t most_mode = 1000;  // a number that surely is none
constexpr const char* binary = "application/octet-stream";

/// 128 bits that nobody can guess.
std::string make_token() {
  std::random_device source;
  std::string token;
  for (int k = 0; k < 4; ++k) token += fmt::format("{:08x}", source());
  return token;
}

/// Takes as long whichever character differs.
bool same(const std::string& a, const std::string& b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t k = 0; k < a.size(); ++k) difference |= static_cast<unsigned char>(a[k] ^ b[k]);
  return difference == 0;
}

std::uint64_t number_in(const httplib::Request& request, const char* name) {
  const std::string text = request.get_param_value(name);
  std::uint64_t value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

/// The state; the field is in it only when the tab does not have it yet.
std::string state_bytes(const StudioState& state, std::uint64_t known) {
  ViewPack pack;
  pack.meta = {{"revision", state.revision},
               {"result", state.result->id},
               {"design", Json::parse(design_text(state.design))},
               {"problem", state.problem},
               {"undo", state.undo},
               {"redo", state.redo},
               {"controls", state.result->controls},
               {"free_corners", state.result->free_corners},
               {"seconds", state.result->seconds},
               {"mode", state.result->mode},
               {"eigenvalues", state.result->eigenvalues},
               {"memory", memory_bytes()},
               {"holonomy", state.result->surface.connection().generator_holonomy},
               {"loop_index", state.result->surface.connection().loop_index},
               {"offered", scalar_list(state.result->field.n)}};
  if (state.result->id != known) {
    add_field(pack, state.result->output());
    add_singularities(pack, state.result->output());
    pack.add("creases", state.result->creases);
    pack.add("crease_offsets", state.result->crease_offsets);
  }
  return pack.bytes();
}

/// A folder of our own for exported files, gone when done.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (fs::temp_directory_path() / "alcap-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw Failure(Exit::output, "no temporary folder can be made");
    path_ = name;
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

class Handlers {
 public:
  Handlers(StudioSession& session, const StudioServerOptions& options) : session_(session), options_(options) {}

  void add(httplib::Server& server, int port) {
    port_ = port;
    connections_.emplace(port);
    server.set_payload_max_length(largest_body);
    server.set_read_timeout(read_timeout);
    server.set_pre_routing_handler([this](const auto& request, auto& response) { return guard(request, response); });
    server.set_exception_handler([](const auto&, auto& response, const std::exception_ptr& thrown) {
      try {
        std::rethrow_exception(thrown);
      } catch (const std::exception& e) {
        answer(response, 500, e.what());
      }
    });
    add_reading(server);
    add_editing(server);
  }

  [[nodiscard]] std::string url() const { return fmt::format("http://127.0.0.1:{}/?t={}", port_, token_); }

 private:
  void add_reading(httplib::Server& server) {
    server.Get("/", [this](const auto&, auto& response) {
      // From a provider of known length: what is set as content the library packs, which takes a second for the page.
      const auto page =
          std::make_shared<const std::string>(html_page(Json{{"mode", "studio"}, {"title", options_.title}}));
      response.set_content_provider(page->size(), "text/html; charset=utf-8",
                                    [page](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
                                      return sink.write(page->data() + offset, length);
                                    });
    });
    server.Get("/api/mesh", [this](const auto&, auto& response) {
      ViewPack pack;
      // Json{}: in a generic lambda clang 14 never destroys what an assignment from plain braces replaces.
      pack.meta = Json{{"title", options_.title},
                       {"euler", session_.surface().topology().euler()},
                       {"boundary", !session_.surface().topology().loops.empty()},
                       {"came", session_.came()},
                       {"file", session_.file().string()}};
      add_mesh(pack, session_.surface());
      add_loops(pack, session_.surface());
      response.set_content(pack.bytes(), binary);
    });
    server.Get("/api/state",
               [this](const auto& request, auto& response) { state(request, response, session_.state()); });
    server.Get("/api/wait", [this](const auto& request, auto& response) {
      const Json body{{"revision", session_.wait(number_in(request, "known"), longest_wait)}};
      response.set_content(text_of(body), "application/json");
    });
    server.Get("/api/details", [this](const auto& request, auto& response) { details(request, response); });
    server.Get("/api/design", [this](const auto&, auto& response) {
      attach(response, design_text(session_.state().design), options_.title + ".design.json", "application/json");
    });
    server.Get("/api/export", [this](const auto& request, auto& response) { write(request, response); });
  }

  void add_editing(httplib::Server& server) {
    using Base = std::optional<std::uint64_t>;
    changing(server, "/api/edit", [this](const auto& request, Base base) {
      return session_.edit(request.body, request.get_param_value("gesture"), base);
    });
    changing(server, "/api/mode", [this](const auto& request, Base base) {
      return session_.show_mode(static_cast<int>(std::min(number_in(request, "mode"), most_mode)), base);
    });
    changing(server, "/api/keep", [this](const auto&, Base base) { return session_.keep_field(base); });
    changing(server, "/api/undo", [this](const auto&, Base base) { return session_.undo(base); });
    changing(server, "/api/redo", [this](const auto&, Base base) { return session_.redo(base); });
  }

  /// A request that changes what all tabs see, based on the revision that its tab has seen.
  template <class Act>
  void changing(httplib::Server& server, const char* path, Act&& act) {
    server.Post(path, [this, act](const httplib::Request& request, httplib::Response& response) {
      std::optional<std::uint64_t> base;
      if (!request.get_param_value("base").empty()) base = number_in(request, "base");
      try {
        state(request, response, act(request, base));
      } catch (const StudioConflict& e) {
        answer(response, 409, e.what());
      } catch (const FileError& e) {
        answer(response, 400, e.what());
      } catch (const OptionError& e) {
        answer(response, 400, e.what());
      }
    });
  }

  static void answer(httplib::Response& response, int status, const std::string& message) {
    response.status = status;
    response.set_content(text_of(Json{{"error", message}}), "application/json");
  }

  static void attach(httplib::Response& response, const std::string& content, const std::string& name,
                     const char* type) {
    std::string plain;
    for (const char c : name)
      plain += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-' ? c : '_';
    response.set_header("Content-Disposition", "attachment; filename=\"" + plain + "\"");
    response.set_content(content, type);
  }

  httplib::Server::HandlerResponse guard(const httplib::Request& request, httplib::Response& response) {
    using Next = httplib::Server::HandlerResponse;
    response.set_header("Cache-Control", "no-store");
    response.set_header("X-Content-Type-Options", "nosniff");
    response.set_header("Referrer-Policy", "no-referrer");
    response.set_header("Cross-Origin-Resource-Policy", "same-origin");
    response.set_header(
        "Content-Security-Policy",
        "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; connect-src 'self'; "
        "img-src data: blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
    const std::array<std::string, 2> hosts{fmt::format("127.0.0.1:{}", port_), fmt::format("localhost:{}", port_)};
    const std::string host = request.get_header_value("Host"), origin = request.get_header_value("Origin");
    const std::string site = request.get_header_value("Sec-Fetch-Site");
    // A proxy in between could look at another one of several.
    const bool once = request.get_header_value_count("Host") == 1 && request.get_header_value_count("Origin") <= 1;
    const bool ours = once && (host == hosts[0] || host == hosts[1]);
    const bool asked_by_us = origin.empty() || origin == "http://" + host;
    const bool near = site.empty() || site == "same-origin" || site == "none";
    if (!ours || !asked_by_us || !near || !same(request.get_param_value("t"), token_)) {
      answer(response, 403, "open the address that alcap studio printed; it changes with every start");
      return Next::Handled;
    }
    connections_->trust(request.remote_port);
    if (options_.opened) options_.opened();
    return Next::Unhandled;
  }

  void state(const httplib::Request& request, httplib::Response& response, const StudioState& state) const {
    response.set_content(state_bytes(state, number_in(request, "have")), binary);
  }

  /// A part of what the page shows of the field, unless an edit makes that field a former one.
  void details(const httplib::Request& request, httplib::Response& response) const {
    const std::string part = request.get_param_value("part");
    const auto which = std::find(part_names.begin(), part_names.end(), part);
    if (which == part_names.end()) return answer(response, 400, "unknown part");
    const std::uint64_t id = number_in(request, "result");
    const auto outdated = [&] { return session_.result() != id; };
    const std::shared_ptr<const StudioResult> result = session_.state().result;
    try {
      if (result->id != id) throw Cancelled();
      response.set_content(result->part(StudioPart(which - part_names.begin()), {.cancel = outdated}), binary);
    } catch (const Cancelled&) {
      response.status = 204;  // nothing wrong: the field is another by now
    }
  }

  /// One of the files of a format, counted from 0: the field in .ply, .vtp, ...
  void write(const httplib::Request& request, httplib::Response& response) const {
    const std::string format = request.get_param_value("format");
    const std::vector<std::string> known = field_formats();
    if (std::find(known.begin(), known.end(), format) == known.end())
      return answer(response, 400, "unknown format; see alcap field --help");
    const ScratchFolder folder;
    const StudioState now = session_.state();
    const auto files = write_field(now.result->output(), folder.path() / (fs::path("field.") += format));
    const std::uint64_t part = number_in(request, "part");
    if (part >= files.size()) return answer(response, 404, "no such file");
    std::ifstream in(files[part], std::ios::binary);
    const std::string content{std::istreambuf_iterator<char>(in), {}};
    response.set_header("X-Files", std::to_string(files.size()));
    attach(response, content, options_.title + "." + files[part].filename().string(), binary);
  }

  StudioSession& session_;
  const StudioServerOptions& options_;
  std::string token_ = make_token();
  int port_ = 0;
  std::optional<ConnectionGuard> connections_;
};

}  // namespace

void check_studio() { check_page(); }

void serve_studio(StudioSession& session, const StudioServerOptions& options,
                  const std::function<void(const std::string& url)>& ready) {
  httplib::Server server;
  server.new_task_queue = [] { return new httplib::ThreadPool(threads); };
  Handlers handlers(session, options);
  // Loopback, whatever the options: there is no switch for the rest of the network.
  const int port = options.port == 0                                ? server.bind_to_any_port("127.0.0.1")
                   : server.bind_to_port("127.0.0.1", options.port) ? options.port
                                                                    : -1;
  if (port <= 0) throw Failure(Exit::output, fmt::format("port {} is taken; give another --port", options.port));
  handlers.add(server, port);
  ready(handlers.url());
  server.listen_after_bind();
}

}  // namespace alcap::app

#else

namespace alcap::app {

void check_studio() {
  throw Failure(Exit::usage,
                "this alcap was built without its studio, which needs cpp-httplib (Debian: apt-get install "
                "libcpp-httplib-dev); install it and build again");
}

void serve_studio(StudioSession&, const StudioServerOptions&, const std::function<void(const std::string&)>&) {
  check_studio();
}

}  // namespace alcap::app

#endif
