// SPDX-License-Identifier: MIT
//
// driver.cpp: runs a fuzz target where libFuzzer is not at hand: every file of the given folders, then random changes
// of them until the time is over. Takes libFuzzer's options -max_total_time (ALCAP_FUZZ_SECONDS wins), -seed and
// -artifact_prefix. The input that ends the program is written to PREFIXcrash.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Input = std::vector<std::uint8_t>;

Input current;
std::string crash_file = "crash";

void keep_input(int signal_number) {
  const int file = ::open(crash_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (file >= 0) (void)!::write(file, current.data(), current.size());
  ::signal(signal_number, SIG_DFL);
  ::raise(signal_number);
}

void run(const Input& input) {
  current = input;
  (void)LLVMFuzzerTestOneInput(current.data(), current.size());
}

Input changed(const std::vector<Input>& corpus, std::mt19937_64& random) {
  static constexpr std::string_view telling = "0123456789-+.eE/#\\ \n\r\tvfn{}[]\",:";
  Input out = corpus[random() % corpus.size()];
  for (std::uint64_t k = random() % 8; k < 8; ++k) {
    const std::size_t at = out.empty() ? 0 : random() % out.size();
    switch (random() % 6) {
      case 0:
        if (!out.empty()) out[at] = static_cast<std::uint8_t>(random());
        break;
      case 1:
        if (!out.empty()) out[at] = static_cast<std::uint8_t>(telling[random() % telling.size()]);
        break;
      case 2:
        out.insert(out.begin() + static_cast<std::ptrdiff_t>(at),
                   static_cast<std::uint8_t>(telling[random() % telling.size()]));
        break;
      case 3:
        if (!out.empty()) out.erase(out.begin() + static_cast<std::ptrdiff_t>(at));
        break;
      case 4: {  // a piece of another one
        const Input& other = corpus[random() % corpus.size()];
        if (other.empty()) break;
        const std::size_t from = random() % other.size(), count = random() % (other.size() - from) + 1;
        out.insert(out.begin() + static_cast<std::ptrdiff_t>(at), other.begin() + static_cast<std::ptrdiff_t>(from),
                   other.begin() + static_cast<std::ptrdiff_t>(from + count));
        break;
      }
      default:
        out.resize(at);
        break;
    }
  }
  if (out.size() > 4096) out.resize(4096);
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  double seconds = 0;
  std::uint64_t seed = 0;
  std::vector<Input> corpus;
  for (int k = 1; k < argc; ++k) {
    const std::string text = argv[k];
    const std::size_t equals = text.find('=');
    const std::string value = equals == std::string::npos ? "" : text.substr(equals + 1);
    if (text.starts_with("-max_total_time=")) seconds = std::stod(value);
    if (text.starts_with("-seed=")) seed = std::stoull(value);
    if (text.starts_with("-artifact_prefix=")) crash_file = value + "crash";
    if (text.starts_with("-")) continue;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(text)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());  // the same seed gives the same inputs on every file system
    for (const auto& name : files) {
      std::ifstream file(name, std::ios::binary);
      corpus.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    }
  }
  if (const char* const asked = std::getenv("ALCAP_FUZZ_SECONDS")) seconds = std::stod(asked);
  for (const int number : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL, SIGTERM}) std::signal(number, keep_input);
  for (const Input& input : corpus) run(input);
  if (corpus.empty()) corpus.emplace_back();
  std::mt19937_64 random(seed);
  std::int64_t count = 0;
  const auto start = std::chrono::steady_clock::now();
  while (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() < seconds) {
    run(changed(corpus, random));
    ++count;
  }
  std::printf("%zu inputs replayed, %lld changed ones run\n", corpus.size(), static_cast<long long>(count));
}
