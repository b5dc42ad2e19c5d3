// SPDX-License-Identifier: MIT
#include "python/src/arrays.h"

#include "alcap/arrays.h"

namespace alcap::python {
namespace {

std::string shape_text(const py::array& a) {
  std::string text = "array of shape (";
  for (py::ssize_t k = 0; k < a.ndim(); ++k) text += (k > 0 ? ", " : "") + std::to_string(a.shape(k));
  return text + ") of " + py::str(a.dtype()).cast<std::string>();
}

[[noreturn]] void refuse(const py::array& a, const char* name, const std::string& rule) {
  throw OptionError(name, shape_text(a), rule);
}

py::array array_of(const py::object& values, const char* name) {
  py::array a = py::array::ensure(values);
  if (!a) {
    PyErr_Clear();
    throw OptionError(name, py::str(py::type::of(values)).cast<std::string>(), "must be an array of numbers");
  }
  return a;
}

template <class T>
detail::ThreeColumns<T> columns(const py::array& a) {
  const auto size = static_cast<py::ssize_t>(sizeof(T));
  return {static_cast<const T*>(a.data()), a.shape(0), a.strides(0) / size, a.strides(1) / size};
}

/// Whether an element can be read at a whole number of elements from the first one.
bool direct(const py::array& a) {
  const py::ssize_t size = a.itemsize();
  const bool aligned = reinterpret_cast<std::uintptr_t>(a.data()) % static_cast<std::uintptr_t>(size) == 0;
  return aligned && a.strides(0) % size == 0 && a.strides(1) % size == 0 &&
         a.dtype().attr("isnative").template cast<bool>();
}

template <class T>
py::array_t<T, py::array::c_style | py::array::forcecast> flat(const py::object& values, const char* name,
                                                               const char* kinds, std::int64_t count) {
  const py::array a = array_of(values, name);
  if (std::string(kinds).find(a.dtype().kind()) == std::string::npos && a.size() > 0)
    refuse(a, name, "is of the wrong type");
  if (a.ndim() != 1 || (count >= 0 && a.shape(0) != count))
    refuse(a, name,
           count < 0 ? std::string("must have one dimension") : "must have shape (" + std::to_string(count) + ",)");
  return py::array_t<T, py::array::c_style | py::array::forcecast>(a);
}

}  // namespace

std::string short_repr(const py::handle& value) {
  constexpr py::ssize_t most = 60;
  const py::str text = py::repr(value);
  const auto start = text[py::slice(0, most, 1)].cast<std::string>();
  return py::len(text) > static_cast<std::size_t>(most) ? start + "..." : start;
}

py::array over(const py::dtype& type, Shape shape, const void* data, const py::object& owner, bool writeable) {
  py::array a(type, std::move(shape), data, owner);
  if (!writeable) py::detail::array_proxy(a.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return a;
}

py::array moved_rows(Positions<double> rows) {
  const py::ssize_t count = rows.rows();
  return moved(std::move(rows), {count, 3});
}

Positions<double> positions_of(const py::object& V, const char* name) {
  py::array a = array_of(V, name);
  if (a.ndim() != 2 || a.shape(1) != 3) refuse(a, name, "must have shape (#V, 3)");
  const char kind = a.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u') refuse(a, name, "must hold real numbers");
  const bool single = kind == 'f' && a.itemsize() == 4, wide = kind == 'f' && a.itemsize() == 8;
  if (single && direct(a)) return detail::copy_positions<float>(columns<float>(a));
  if (!wide || !direct(a)) a = py::array_t<double, py::array::c_style | py::array::forcecast>(a);
  return detail::copy_positions<double>(columns<double>(a));
}

Faces faces_of(const py::object& F, const char* name) {
  py::array a = array_of(F, name);
  if (a.ndim() != 2 || a.shape(1) != 3) refuse(a, name, "must have shape (#F, 3)");
  const char kind = a.dtype().kind();
  if (kind != 'i' && kind != 'u') refuse(a, name, "must hold integers");
  if (!direct(a) || a.itemsize() < 4) a = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>(a);
  const bool whole = a.dtype().kind() == 'i';
  if (a.itemsize() == 4)
    return whole ? detail::copy_faces<std::int32_t>(columns<std::int32_t>(a))
                 : detail::copy_faces<std::uint32_t>(columns<std::uint32_t>(a));
  return whole ? detail::copy_faces<std::int64_t>(columns<std::int64_t>(a))
               : detail::copy_faces<std::uint64_t>(columns<std::uint64_t>(a));
}

ComplexVectorX<double> complex_of(const py::object& values, const char* name, std::int64_t count) {
  const auto a = flat<Complex<double>>(values, name, "cfiu", count);
  return Eigen::Map<const ComplexVectorX<double>>(a.data(), a.size());
}

VectorX<double> reals_of(const py::object& values, const char* name, std::int64_t count) {
  const auto a = flat<double>(values, name, "fiu", count);
  return Eigen::Map<const VectorX<double>>(a.data(), a.size());
}

std::vector<Index> indices_of(const py::object& values, const char* name, std::int64_t count) {
  const auto a = flat<std::int64_t>(values, name, "iu", count);
  std::vector<Index> out(static_cast<std::size_t>(a.size()));
  for (std::size_t k = 0; k < out.size(); ++k) {
    const std::int64_t i = a.data()[k];
    if (i < std::numeric_limits<Index>::min() || i > std::numeric_limits<Index>::max())
      throw OptionError(name, i, "does not fit 32 bits");
    out[k] = static_cast<Index>(i);
  }
  return out;
}

SparseMatrix<Complex<double>> sparse_of(const py::tuple& parts, const char* name) {
  using C = Complex<double>;
  const auto data = flat<C>(parts[0], name, "cfiu", -1);
  // SciPy's indices have 32 or 64 bits.
  const std::vector<Index> inner = indices_of(parts[1], name, data.size());
  const std::vector<Index> outer = indices_of(parts[2], name);
  const auto n = static_cast<Eigen::Index>(outer.size()) - 1;
  if (n < 0 || outer.front() != 0 || outer.back() != data.size())
    throw OptionError(name, std::to_string(data.size()) + " entries", "must be a compressed matrix");
  for (Eigen::Index j = 0; j < n; ++j)
    if (outer.data()[j] > outer.data()[j + 1]) throw OptionError(name, j, "is a column that ends before it starts");
  for (Eigen::Index k = 0; k < data.size(); ++k)
    if (inner.data()[k] < 0 || inner.data()[k] >= n) throw OptionError(name, inner.data()[k], "is not a row");
  return Eigen::Map<const SparseMatrix<C>>(n, n, data.size(), outer.data(), inner.data(), data.data());
}

py::array moved_faces(Faces rows) {
  const py::ssize_t count = rows.rows();
  return moved(std::move(rows), {count, 3});
}

std::vector<std::array<Index, 2>> pairs_of(const py::object& values, const char* name) {
  const auto flat = py::array::ensure(values);
  if (!flat || flat.ndim() != 2 || flat.shape(1) != 2)
    throw OptionError(name, py::str(py::type::of(values)).cast<std::string>(), "must be an array of shape (k, 2)");
  const std::vector<Index> list = indices_of(flat.attr("ravel")(), name);
  std::vector<std::array<Index, 2>> out(list.size() / 2);
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = {list[2 * k], list[2 * k + 1]};
  return out;
}

}  // namespace alcap::python
