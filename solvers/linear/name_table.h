// SPDX-License-Identifier: MIT
//
// name_table.h: a table of named backends that can grow while others read it. Internal to solvers/.
#pragma once

#include <algorithm>
#include <cctype>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <string>
#include <utility>
#include <vector>

#include "alcap/backends.h"

namespace alcap::detail {

/// Throws OptionError "unknown" with the list of what there is.
[[noreturn]] inline void throw_unknown(const char* field, const std::string& name,
                                       const std::vector<std::string>& known) {
  std::string list = "unknown; there are auto";
  for (const std::string& k : known) list += ", " + k;
  throw OptionError(field, "'" + name + "'", list);
}

/// Built-in entries first, then those added, in their order. All functions may be called on several threads at once.
template <class Entry>
class NameTable {
 public:
  struct Row {
    std::string name;
    std::shared_ptr<const Entry> entry;
    Row(std::string n, Entry e) : name(std::move(n)), entry(std::make_shared<const Entry>(std::move(e))) {}
  };

  explicit NameTable(std::vector<Row> built_in) : rows_(std::move(built_in)) {}

  /// Throws OptionError for a name that nobody could ask for, or that is taken.
  BackendRegistration add(const std::string& name, Entry entry) {
    const auto refuse = [&](const char* rule) { throw OptionError("name", "'" + name + "'", rule); };
    if (name.empty()) refuse("must not be empty");
    if (std::any_of(name.begin(), name.end(), [](unsigned char c) { return std::isspace(c) != 0; }))
      refuse("must not contain blanks");
    if (name == "auto") refuse("is the library's own choice");
    Row row(name, std::move(entry));
    const std::unique_lock lock(mutex_);
    if (find(name) != rows_.end()) refuse("is taken");
    rows_.push_back(std::move(row));
    return BackendRegistration([this, name] { remove(name); });
  }

  [[nodiscard]] std::vector<std::string> names() const {
    const std::shared_lock lock(mutex_);
    std::vector<std::string> all;
    for (const Row& row : rows_) all.push_back(row.name);
    return all;
  }

  /// Shared, so that what it makes goes on when the name is taken out. Throws OptionError naming `field` and listing
  /// the known names.
  [[nodiscard]] std::shared_ptr<const Entry> get(const char* field, const std::string& name) const {
    {
      const std::shared_lock lock(mutex_);
      const auto row = find(name);
      if (row != rows_.end()) return row->entry;
    }
    throw_unknown(field, name, names());
  }

 private:
  [[nodiscard]] auto find(const std::string& name) const {
    return std::find_if(rows_.begin(), rows_.end(), [&](const Row& row) { return row.name == name; });
  }

  void remove(const std::string& name) {
    std::shared_ptr<const Entry> last;  // what it holds is destroyed without the lock
    const std::unique_lock lock(mutex_);
    const auto row = find(name);
    if (row == rows_.end()) return;
    last = row->entry;
    rows_.erase(row);
  }

  mutable std::shared_mutex mutex_;
  std::vector<Row> rows_;
};

}  // namespace alcap::detail
