// SPDX-License-Identifier: MIT
//
// cli.cpp: the only file that includes CLI11.
#include "apps/alcap/options/cli.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <type_traits>

namespace alcap::app::cli {
namespace {

CLI::Option* of(void* option) { return static_cast<CLI::Option*>(option); }

/// CLI11's help with descriptions wrapped to the width of a terminal.
class WrappedHelp : public CLI::Formatter {
 public:
  std::string make_option_desc(const CLI::Option* option) const override {
    const std::size_t width = 100 - get_column_width();
    std::string text, line;
    std::istringstream words(CLI::Formatter::make_option_desc(option));
    for (std::string word; words >> word;) {
      if (!line.empty() && line.size() + 1 + word.size() > width) {
        text += line + "\n";
        line.clear();
      }
      line += (line.empty() ? "" : " ") + word;
    }
    return text + line;
  }
};

/// CLI11's own checks of ranges let NaN pass, and write the limits of a double with 309 digits.
CLI::Validator numbers(const std::string& shown, const std::string& rule, std::function<bool(double)> fits) {
  return {[rule, fits = std::move(fits)](const std::string& text) {
            double value = 0;
            const bool fine = CLI::detail::lexical_cast(text, value) && fits(value);
            return fine ? std::string() : fmt::format("{} is not {}", text, rule);
          },
          shown};
}

std::string no_name(const std::string& text) { return text.empty() ? "the name is empty" : ""; }

}  // namespace

Option* Option::required(bool value) {
  of(option_)->required(value);
  return this;
}
Option* Option::type_name(const std::string& name) {
  of(option_)->type_name(name);
  return this;
}
Option* Option::group(const std::string& name) {
  of(option_)->group(name);
  return this;
}
Option* Option::capture_default_str() {
  of(option_)->capture_default_str();
  return this;
}
Option* Option::default_str(const std::string& text) {
  of(option_)->default_str(text);
  return this;
}
Option* Option::delimiter(char between) {
  of(option_)->delimiter(between);
  return this;
}
Option* Option::allow_extra_args(bool value) {
  of(option_)->allow_extra_args(value);
  return this;
}
Option* Option::expected(int count) {
  of(option_)->expected(count);
  return this;
}
Option* Option::expected(int least, int most) {
  of(option_)->expected(least, most);
  return this;
}
Option* Option::check(const IsMember& allowed) {
  of(option_)->check(CLI::IsMember(allowed.values));
  return this;
}
Option* Option::check(const Range& allowed) {
  if (allowed.whole) {
    of(option_)->check(CLI::Range(static_cast<int>(allowed.from), static_cast<int>(allowed.to)));
  } else {
    of(option_)->check(numbers(fmt::format("FLOAT in [{} - {}]", allowed.from, allowed.to),
                               fmt::format("a number from {} to {}", allowed.from, allowed.to),
                               [allowed](double x) { return x >= allowed.from && x <= allowed.to; }));
  }
  return this;
}
Option* Option::check(Positive) {
  of(option_)->check(
      numbers("POSITIVE", "a finite number above 0", [](double x) { return x > 0 && std::isfinite(x); }));
  return this;
}
Option* Option::check(Fraction) {
  of(option_)->check(numbers("FRACTION", "a number above 0 and below 1", [](double x) { return x > 0 && x < 1; }));
  return this;
}
Option* Option::check(std::string (*problem)(const std::string& text)) {
  of(option_)->check(problem);
  return this;
}
std::size_t Option::count() const { return of(option_)->count(); }

struct App::Impl {
  std::unique_ptr<CLI::App> program = {};  ///< none for a subcommand, which its program owns
  CLI::App* app = nullptr;
  std::vector<std::unique_ptr<Option>> options = {};
  std::vector<std::unique_ptr<App>> subcommands = {};
};

App::App(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
App::App(const std::string& description, const std::string& name) : impl_(std::make_unique<Impl>()) {
  impl_->program = std::make_unique<CLI::App>(description, name);
  impl_->app = impl_->program.get();
  impl_->app->formatter(std::make_shared<WrappedHelp>());  // before the subcommands, which inherit it
}
App::~App() = default;

Option* App::keep(void* option) {
  impl_->options.push_back(std::make_unique<Option>(option));
  return impl_->options.back().get();
}

App* App::add_subcommand(const std::string& name, const std::string& summary) {
  auto impl = std::make_unique<Impl>();
  impl->app = impl_->app->add_subcommand(name, summary);
  impl_->subcommands.push_back(std::unique_ptr<App>(new App(std::move(impl))));
  return impl_->subcommands.back().get();
}
void App::footer(const std::string& text) { impl_->app->footer(text); }
void App::require_subcommand(int least, int most) {
  impl_->app->require_subcommand(static_cast<std::size_t>(least), static_cast<std::size_t>(most));
}

template <class T>
Option* App::add_option(const std::string& names, T& variable, const std::string& help) {
  CLI::Option* const option = impl_->app->add_option(names, variable, help);
  // The text of a shell variable that is not set; elsewhere an empty path stands for an option that was not given.
  if constexpr (std::is_same_v<T, std::filesystem::path>) option->check(no_name);
  return keep(option);
}
template <class T>
Option* App::add_option_function(const std::string& names, const std::function<void(const T&)>& take,
                                 const std::string& help) {
  return keep(impl_->app->add_option_function<T>(names, take, help));
}
Option* App::add_flag(const std::string& names, bool& variable, const std::string& help) {
  return keep(impl_->app->add_flag(names, variable, help));
}
Option* App::add_flag_function(const std::string& names, const std::function<void(std::int64_t)>& take,
                               const std::string& help) {
  return keep(impl_->app->add_flag_function(names, take, help));
}
Option* App::get_option(const std::string& name) {
  try {
    return keep(impl_->app->get_option(name));
  } catch (const CLI::OptionNotFound& e) {
    throw std::logic_error(e.what());
  }
}
std::vector<std::pair<std::string, std::string>> App::given(const std::vector<std::string>& names) const {
  std::vector<std::pair<std::string, std::string>> texts;
  for (const std::string& name : names)
    if (const CLI::Option* const option = impl_->app->get_option_no_throw(name); option != nullptr)
      for (const std::string& text : option->results()) texts.emplace_back(name, text);
  return texts;
}

std::optional<std::string> App::parse(int argc, const char* const* argv) {
  try {
    impl_->app->parse(argc, argv);
  } catch (const CLI::Success&) {  // --help
    return help();
  } catch (const CLI::ParseError& e) {
    throw ParseError(e.what());
  }
  return std::nullopt;
}
std::string App::help() const { return impl_->app->help(); }
bool App::parsed() const { return impl_->app->parsed(); }
std::string App::parsed_subcommand() const {
  const auto parsed = impl_->app->get_subcommands();
  return parsed.empty() ? "" : parsed.front()->get_name();
}

// The kinds of variables that options have; another is one line here.
#define ALCAP_OPTION_OF(...) template Option* App::add_option(const std::string&, __VA_ARGS__&, const std::string&);
ALCAP_OPTION_OF(int)
ALCAP_OPTION_OF(std::uint64_t)
ALCAP_OPTION_OF(double)
ALCAP_OPTION_OF(std::string)
ALCAP_OPTION_OF(std::filesystem::path)
ALCAP_OPTION_OF(std::vector<int>)
ALCAP_OPTION_OF(std::vector<std::string>)
ALCAP_OPTION_OF(std::array<int, 2>)
ALCAP_OPTION_OF(std::array<double, 2>)
#undef ALCAP_OPTION_OF

template Option* App::add_option_function(const std::string&, const std::function<void(const double&)>&,
                                          const std::string&);
template Option* App::add_option_function(const std::string&, const std::function<void(const std::string&)>&,
                                          const std::string&);
template Option* App::add_option_function(const std::string&,
                                          const std::function<void(const std::vector<std::string>&)>&,
                                          const std::string&);

}  // namespace alcap::app::cli
