// SPDX-License-Identifier: MIT
#include "src/distributed/together.h"

#include <algorithm>
#include <climits>
#include <new>
#include <nlohmann/json.hpp>

#include "alcap/errors.h"
#include "src/base/array.h"
#include "src/distributed/defects.h"

namespace alcap::detail::distributed {
namespace {

using Json = nlohmann::json;

/// An exception as text: its type, its message and its parts.
Json described(const std::exception_ptr& caught) {
  try {
    std::rethrow_exception(caught);
  } catch (const FileError& e) {
    return {{"type", "file"}, {"what", e.what()}, {"path", e.path()}, {"line", e.line()}, {"offset", e.offset()}};
  } catch (const MeshError& e) {
    return {{"type", "mesh"},
            {"what", e.what()},
            {"defect", static_cast<int>(e.defect())},
            {"element", static_cast<int>(e.element())},
            {"count", e.count()},
            {"first", e.first()}};
  } catch (const OptionError& e) {
    return {{"type", "option"}, {"field", e.field()}, {"value", e.value()}, {"rule", e.rule()}};
  } catch (const SolveError& e) {
    return {{"type", "solve"}, {"what", e.what()}};
  } catch (const Cancelled&) {
    return {{"type", "cancelled"}};
  } catch (const std::bad_alloc&) {
    return {{"type", "memory"}};
  } catch (const std::exception& e) {
    return {{"type", "other"}, {"what", e.what()}};
  } catch (...) {
    return {{"type", "other"}, {"what", "unknown exception"}};
  }
}

[[noreturn]] void throw_described(const Json& e) {
  const auto type = e["type"].get<std::string>();
  const auto text = [&](const char* key) { return e[key].get<std::string>(); };
  if (type == "file") throw FileError(text("what"), text("path"), e["line"], e["offset"]);
  if (type == "mesh")
    throw MeshError(text("what"), static_cast<Defect>(e["defect"].get<int>()),
                    static_cast<Element>(e["element"].get<int>()), e["count"],
                    e["first"].get<std::vector<std::int32_t>>());
  if (type == "option") throw OptionError(text("field"), text("value"), text("rule"));
  if (type == "solve") throw SolveError(text("what"));
  if (type == "cancelled") throw Cancelled();
  if (type == "memory") throw std::bad_alloc();
  throw Error(text("what"));
}

template <class T>
T reduced(T value, MPI_Datatype type, MPI_Op op) {
  T result{};
  MPI_Allreduce(&value, &result, 1, type, op, MPI_COMM_WORLD);
  return result;
}

}  // namespace

int rank() {
  int r = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &r);
  return r;
}
int ranks() {
  int p = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &p);
  return p;
}

double sum(double value) { return reduced(value, MPI_DOUBLE, MPI_SUM); }
std::int64_t sum(std::int64_t value) { return reduced(value, MPI_INT64_T, MPI_SUM); }
double largest(double value) { return reduced(value, MPI_DOUBLE, MPI_MAX); }
std::int64_t largest(std::int64_t value) { return reduced(value, MPI_INT64_T, MPI_MAX); }
bool any(bool value) { return largest(std::int64_t{value}) != 0; }

std::int64_t sum_before(std::int64_t value) {
  std::int64_t result = 0;
  MPI_Exscan(&value, &result, 1, MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
  return rank() == 0 ? 0 : result;
}

void sum_all(std::span<double> values) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
}
void sum_all(std::span<std::int64_t> values) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
}

void largest_all(std::span<double> values) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
}

void share_from_first(std::span<double> values) {
  MPI_Bcast(values.data(), static_cast<int>(values.size()), MPI_DOUBLE, 0, MPI_COMM_WORLD);
}

void spread(double value, double (&out)[3]) {
  out[0] = reduced(value, MPI_DOUBLE, MPI_MIN);
  out[1] = sum(value) / ranks();
  out[2] = largest(value);
}

std::vector<char> gather_bytes(std::span<const char> mine) {
  const auto size = static_cast<std::int64_t>(mine.size());
  const std::int64_t all = sum(size);
  if (all > INT_MAX) throw SolveError("more than 2 GB would have to be gathered on every rank");
  std::vector<int> counts(at(ranks())), starts(at(ranks()));
  const int count = static_cast<int>(size);
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, MPI_COMM_WORLD);
  for (std::size_t r = 1; r < counts.size(); ++r) starts[r] = starts[r - 1] + counts[r - 1];
  std::vector<char> bytes(at(all));
  MPI_Allgatherv(mine.data(), count, MPI_CHAR, bytes.data(), counts.data(), starts.data(), MPI_CHAR, MPI_COMM_WORLD);
  return bytes;
}

void throw_together(const std::exception_ptr& caught) {
  if (!any(caught != nullptr)) return;
  const std::string mine = caught ? described(caught).dump() + "\n" : "";
  const std::vector<char> all = gather_bytes(mine);
  std::vector<Json> found;
  for (auto begin = all.begin(); begin != all.end();) {
    const auto end = std::find(begin, all.end(), '\n');
    found.push_back(Json::parse(begin, end));
    begin = end + 1;
  }
  std::vector<NamedDefect> defects;
  for (const Json& e : found) {
    if (e["type"] != "mesh") throw_described(e);
    defects.push_back({static_cast<Defect>(e["defect"].get<int>()), static_cast<Element>(e["element"].get<int>()),
                       e["count"], e["first"].get<std::vector<Index>>()});
  }
  if (defects.size() == 1) throw_described(found[0]);
  throw_first_defect(defects);
}

}  // namespace alcap::detail::distributed
