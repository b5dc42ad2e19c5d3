// SPDX-License-Identifier: MIT
#include "src/design/file/json_tree.h"

#include <algorithm>
#include <set>

#include "alcap/errors.h"

namespace alcap::detail {

const JsonTree* JsonTree::find(std::string_view key) const {
  const auto found = std::find(keys_.begin(), keys_.end(), key);
  return found == keys_.end() ? nullptr : &values_[static_cast<std::size_t>(found - keys_.begin())];
}

JsonTree& JsonTree::operator[](std::string_view key) {
  const auto found = std::find(keys_.begin(), keys_.end(), key);
  if (found != keys_.end()) return values_[static_cast<std::size_t>(found - keys_.begin())];
  return add(std::string(key), {});
}

JsonTree& JsonTree::push_back(JsonTree value) {
  kind_ = Kind::list;
  return values_.emplace_back(std::move(value));
}

JsonTree& JsonTree::add(std::string key, JsonTree value) {
  kind_ = Kind::object;
  values_.push_back(std::move(value));
  try {
    keys_.push_back(std::move(key));
  } catch (...) {
    values_.pop_back();
    throw;
  }
  return values_.back();
}

std::string JsonTree::text(int indent) const {
  std::string out;
  write(out, indent, 0);
  return out;
}

void JsonTree::write(std::string& out, int indent, int depth) const {
  const auto dumped = [](const Scalar& s) { return s.dump(-1, ' ', false, Scalar::error_handler_t::replace); };
  if (kind_ == Kind::scalar) {
    out += dumped(scalar_);
    return;
  }
  const auto line = [&](int level) {
    if (indent >= 0) out.append(1, '\n').append(static_cast<std::size_t>(indent * level), ' ');
  };
  out += is_object() ? '{' : '[';
  for (std::size_t k = 0; k < values_.size(); ++k) {
    if (k > 0) out += ',';
    line(depth + 1);
    if (is_object()) out += dumped(keys_[k]) + (indent >= 0 ? ": " : ":");
    values_[k].write(out, indent, depth + 1);
  }
  if (!values_.empty()) line(depth);
  out += is_object() ? '}' : ']';
}

namespace {

/// What nlohmann's reader tells, as a tree.
class TreeBuilder {
 public:
  using Json = nlohmann::json;

  TreeBuilder(std::string_view text, const std::string& name, std::size_t deepest)
      : text_(text), name_(name), deepest_(deepest) {}
  [[nodiscard]] JsonTree take() { return std::move(root_); }

  bool null() { return put({}); }
  bool boolean(bool value) { return put(value); }
  bool number_integer(Json::number_integer_t value) { return put(value); }
  bool number_unsigned(Json::number_unsigned_t value) { return put(value); }
  bool number_float(Json::number_float_t value, const std::string&) { return put(value); }
  bool string(std::string& value) { return put(value); }
  bool binary(Json::binary_t&) { return false; }
  bool start_object(std::size_t) {
    open(JsonTree::object());
    keys_.emplace_back();
    return true;
  }
  bool key(std::string& value) {
    if (!keys_.back().insert(value).second)
      throw FileError(name_ + ": the key " + Json(value).dump() + " is given twice in one object", name_);
    key_ = std::move(value);
    return true;
  }
  bool end_object() {
    keys_.pop_back();
    open_.pop_back();
    return true;
  }
  bool start_array(std::size_t) {
    open(JsonTree::list());
    return true;
  }
  bool end_array() {
    open_.pop_back();
    return true;
  }
  [[noreturn]] bool parse_error(std::size_t, const std::string&, const Json::exception& error) {
    const auto* const e = dynamic_cast<const Json::parse_error*>(&error);
    if (e == nullptr) throw FileError(name_ + ": not usable JSON: " + error.what(), name_);
    const auto end = std::min(e->byte, text_.size());
    const auto line = 1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(end), '\n');
    const std::string what = e->what();
    const auto colon = what.find(": ", what.find("column"));
    throw FileError(name_ + ":" + std::to_string(line) +
                        ": not JSON: " + (colon == std::string::npos ? what : what.substr(colon + 2)),
                    name_, line, static_cast<std::int64_t>(end));
  }

 private:
  JsonTree& place(JsonTree value) {
    if (open_.size() > deepest_) throw FileError(name_ + ": nested too deeply for a design", name_);
    if (open_.empty()) return root_ = std::move(value);
    return open_.back()->is_object() ? open_.back()->add(std::move(key_), std::move(value))
                                     : open_.back()->push_back(std::move(value));
  }
  bool put(JsonTree value) {
    place(std::move(value));
    return true;
  }
  // Those that are open do not grow while the last one is, so that they stay where they are.
  void open(JsonTree value) { open_.push_back(&place(std::move(value))); }

  std::string_view text_;
  const std::string& name_;
  std::size_t deepest_;
  JsonTree root_;
  std::vector<JsonTree*> open_;
  std::vector<std::set<std::string>> keys_;  // of the objects that are open
  std::string key_;
};

}  // namespace

JsonTree parse_json(std::string_view text, const std::string& name, std::size_t deepest) {
  TreeBuilder builder(text, name, deepest);
  nlohmann::json::sax_parse(text.begin(), text.end(), &builder);
  return builder.take();
}

}  // namespace alcap::detail
