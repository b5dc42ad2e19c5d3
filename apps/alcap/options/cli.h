// SPDX-License-Identifier: MIT
//
// cli.h: what the commands use of CLI11, by CLI11's own names. Only cli.cpp includes that library: it is one header of
// templates, and reading it in every command's file took a quarter of the whole build.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace alcap::app::cli {

/// What makes a command line wrong, in a sentence for whoever typed it.
class ParseError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A value of `option` that cannot be used; what functions given to add_option_function throw.
class ValidationError : public ParseError {
 public:
  ValidationError(const std::string& option, const std::string& what) : ParseError(option + ": " + what) {}
};

/// What Option::check takes; --help shows it.
struct IsMember {
  explicit IsMember(std::vector<std::string> which) : values(std::move(which)) {}
  std::vector<std::string> values;
};
/// A number between two, both included: whole if both are.
struct Range {
  Range(int low, int high) : whole(true), from(low), to(high) {}
  Range(double low, double high) : whole(false), from(low), to(high) {}
  bool whole;
  double from, to;
};
struct Positive {};
inline constexpr Positive PositiveNumber{};
struct Fraction {};
inline constexpr Fraction BetweenZeroAndOne{};

/// An option or a positional argument. Lives as long as its App.
class Option {
 public:
  explicit Option(void* option) : option_(option) {}

  Option* required(bool value = true);
  Option* type_name(const std::string& name);
  Option* group(const std::string& name);
  Option* capture_default_str();  ///< --help shows the variable's value of now as the default
  Option* default_str(const std::string& text);
  Option* delimiter(char between);
  Option* allow_extra_args(bool value);
  Option* expected(int count);
  Option* expected(int least, int most);
  Option* check(const IsMember& allowed);
  Option* check(const Range& allowed);
  Option* check(Positive);
  Option* check(Fraction);
  /// The function returns what is wrong with the text, or nothing.
  Option* check(std::string (*problem)(const std::string& text));
  /// How often it was given; known once the command line is parsed.
  [[nodiscard]] std::size_t count() const;

 private:
  void* option_;  ///< CLI11's
};

/// The program or a subcommand.
class App {
 public:
  App(const std::string& description, const std::string& name);
  ~App();
  App(const App&) = delete;
  App& operator=(const App&) = delete;

  /// The subcommand lives as long as this.
  App* add_subcommand(const std::string& name, const std::string& summary);
  /// At the end of --help.
  void footer(const std::string& text);
  void require_subcommand(int least, int most);

  /// Once parsed, the argument is in `variable`. T: bool, int, std::uint64_t, double, std::string, a path, or a vector
  /// or pair of numbers or texts (cli.cpp has the list).
  template <class T>
  Option* add_option(const std::string& names, T& variable, const std::string& help);
  /// Hands the argument to `take`, which throws ValidationError for one that cannot be used. T: double, std::string,
  /// std::vector<std::string>.
  template <class T>
  Option* add_option_function(const std::string& names, const std::function<void(const T&)>& take,
                              const std::string& help);
  Option* add_flag(const std::string& names, bool& variable, const std::string& help);
  /// `take` gets how often the flag was given.
  Option* add_flag_function(const std::string& names, const std::function<void(std::int64_t)>& take,
                            const std::string& help);
  /// Throws std::logic_error if it was not added before.
  Option* get_option(const std::string& name);
  /// What these options were given; names that this program does not know count as not given.
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> given(const std::vector<std::string>& names) const;

  /// Reads the command line: the text to print if --help was asked for, and nothing otherwise. Throws ParseError.
  std::optional<std::string> parse(int argc, const char* const* argv);
  [[nodiscard]] std::string help() const;
  /// Whether the command line named this subcommand.
  [[nodiscard]] bool parsed() const;
  /// Name of the subcommand that the command line named, or empty.
  [[nodiscard]] std::string parsed_subcommand() const;

 private:
  struct Impl;
  explicit App(std::unique_ptr<Impl> impl);
  Option* keep(void* option);
  std::unique_ptr<Impl> impl_;
};

}  // namespace alcap::app::cli
