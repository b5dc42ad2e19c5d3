// SPDX-License-Identifier: MIT
//
// Files are read once and whole, whatever happens to their names meanwhile; what has no end has a limit.
#include "src/base/input_file.h"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <string>
#include <thread>

#include "alcap/control.h"
#include "alcap/errors.h"
#include "tests/support/folder.h"
#include "tests/support/portable.h"

using namespace alcap;
using detail::InputFile;
namespace fs = std::filesystem;

namespace {

void write(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

std::string refusal(const fs::path& path, const detail::InputLimits& limits = {}) {
  try {
    const InputFile file(path, limits);
    return "read " + std::to_string(file.bytes().size()) + " bytes";
  } catch (const FileError& e) {
    CHECK(e.path() == path.string());
    return e.what();
  }
}

bool contains(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("a file is read whole, and stays what it was") {
  const test::Folder folder;
  const fs::path path = folder.path / "a";
  std::string text(3'000'000, 'x');
  for (std::size_t k = 0; k < text.size(); ++k) text[k] = static_cast<char>(k * 7919 >> 3);
  write(path, text);
  const InputFile file(path);
  // Shortened, replaced, gone: the bytes are ours.
  CHECK(::truncate(path.c_str(), 10) == 0);
  CHECK((file.bytes() == text));
  fs::remove(path);
  CHECK((file.bytes() == text));
  write(path, "");
  CHECK(InputFile(path).bytes().empty());
}

TEST_CASE("what is no file, or has no end, is refused") {
  const test::Folder folder;
  CHECK(contains(refusal(folder.path / "none"), "there is no such file"));
  CHECK(contains(refusal(folder.path, {.what = "mesh file"}), "a folder; give the mesh file inside"));
  CHECK(contains(refusal("/dev/zero"), "device"));
  CHECK(contains(refusal("/dev/null"), "device"));
  const fs::path path = folder.path / "a";
  write(path, std::string(1000, 'x'));
  CHECK(contains(refusal(path, {.largest = 999}), "more than 999 bytes"));
  CHECK(contains(refusal(path, {.largest = 1000}), "read 1000 bytes"));
  if (!test::portable && fs::exists("/proc/self/status")) CHECK(InputFile("/proc/self/status").bytes().size() > 10);
}

TEST_CASE("pipes are read to their end, within bounds of size and patience" * doctest::skip(test::portable)) {
  const test::Folder folder;
  const fs::path path = folder.path / "pipe";
  REQUIRE(::mkfifo(path.c_str(), 0600) == 0);
  CHECK(contains(refusal(path, {.writer_seconds = 0.1}), "no program writes into this pipe"));

  const std::string text(500'000, 'y');
  {
    const std::jthread writer([&] { write(path, text); });
    const InputFile file(path);
    CHECK((file.bytes() == text));
  }
  {
    const std::jthread writer([&] {
      const int pipe = ::open(path.c_str(), O_WRONLY);
      (void)!::write(pipe, "z", 1);
      ::usleep(900'000);
      ::close(pipe);
    });
    CHECK(contains(refusal(path, {.silent_seconds = 0.1}), "has stopped"));
  }
  {
    const std::jthread writer([&] {
      const int pipe = ::open(path.c_str(), O_WRONLY);
      ::usleep(200'000);
      ::close(pipe);
    });
    CHECK(contains(refusal(path), "read 0 bytes"));
  }
  {  // without an end
    const int ends = ::open(path.c_str(), O_RDWR);
    std::jthread writer([&](const std::stop_token& stop) {
      const std::string block(4096, 'x');
      while (!stop.stop_requested()) (void)!::write(ends, block.data(), block.size());
    });
    CHECK(contains(refusal(path, {.largest = 1'000'000}), "more than 1000000 bytes"));
    writer.request_stop();
    const int drain = ::open(path.c_str(), O_RDONLY | O_NONBLOCK);
    std::string rest(1 << 20, ' ');
    (void)!::read(drain, rest.data(), rest.size());
    writer.join();
    ::close(drain);
    ::close(ends);
  }
}

TEST_CASE("waiting for a pipe can be cancelled" * doctest::skip(test::portable)) {
  const test::Folder folder;
  const fs::path path = folder.path / "pipe";
  REQUIRE(::mkfifo(path.c_str(), 0600) == 0);
  int asked = 0;
  CHECK_THROWS_AS(controlled({.cancel = [&] { return ++asked > 3; }}, [&] { const InputFile file(path); }), Cancelled);
}
