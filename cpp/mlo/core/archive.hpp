#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "mlo/core/error.hpp"

// How a struct or class becomes bytes and comes back from them, said once for both directions:
//
//   struct Sighting {
//     long id = 0;
//     SE3 T_map_object;
//     static void archive(auto& self, auto& bytes) { bytes(self.id, self.T_map_object); }
//   };
//
// Numbers are little-endian and keep every bit; lists are preceded by their length (64 bits), optional values
// by a byte. There are no names and no versions in between: the file around them says what follows.
namespace mlo {

static_assert(std::endian::native == std::endian::little,
              "archives are copied from and to memory as they are");
static_assert(sizeof(long) == 8 && sizeof(std::size_t) == 8, "long and std::size_t are archived as 64 bits");

template <class T>
concept PlainNumber = std::is_arithmetic_v<T> || std::is_enum_v<T>;

template <class T>
concept KeyedMap = requires {
  typename T::mapped_type;
};

template <class T>
concept KeySet = requires {
  typename T::key_type;
}
&&!KeyedMap<T>;

/// Appends values to a string of bytes.
class ArchiveWriter {
 public:
  static constexpr bool kReads = false;
  template <class... Ts>
  void operator()(const Ts&... values) {
    (put(values), ...);
  }
  const std::string& bytes() const { return bytes_; }
  std::string take() { return std::move(bytes_); }

 private:
  void put_raw(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }
  template <PlainNumber T>
  void put(const T& value) {
    put_raw(&value, sizeof(T));
  }
  template <class T>
  void put_list(const T& list) {
    put(std::uint64_t{list.size()});
    for (const auto& value : list) put(value);
  }
  template <class T>
  void put(const std::vector<T>& values) {
    if constexpr (PlainNumber<T>) {
      put(std::uint64_t{values.size()});
      put_raw(values.data(), values.size() * sizeof(T));
    } else {
      put_list(values);
    }
  }
  template <class T>
  void put(const std::deque<T>& values) {
    put_list(values);
  }
  template <KeyedMap T>
  void put(const T& values) {
    put_list(values);
  }
  template <KeySet T>
  void put(const T& values) {
    put_list(values);
  }
  template <class A, class B>
  void put(const std::pair<A, B>& pair) {
    (*this)(pair.first, pair.second);
  }
  void put(const std::string& text) {
    put(std::uint64_t{text.size()});
    bytes_ += text;
  }
  template <class T, std::size_t N>
  void put(const std::array<T, N>& values) {
    if constexpr (PlainNumber<T>) {
      put_raw(values.data(), sizeof(values));
    } else {
      for (const T& value : values) put(value);
    }
  }
  template <class T, std::size_t N>
  void put(const T (&values)[N]) {
    for (const T& value : values) put(value);
  }
  template <class T>
  void put(const std::optional<T>& value) {
    put(value.has_value());
    if (value) put(*value);
  }
  template <class T, int Rows, int Cols, int Options>
  void put(const Eigen::Matrix<T, Rows, Cols, Options>& matrix) {
    static_assert(Rows > 0 && Cols > 0, "of a size that is known when compiling");
    put_raw(matrix.data(), sizeof(T) * Rows * Cols);
  }
  void put(const Eigen::Quaterniond& rotation) { put(rotation.coeffs()); }
  template <class T>
  requires requires(const T& value, ArchiveWriter& writer) { T::archive(value, writer); }
  void put(const T& value) { T::archive(value, *this); }

  std::string bytes_;
};

/// Takes the values out again, in the same order.
class ArchiveReader {
 public:
  static constexpr bool kReads = true;

  /// @param bytes   kept by the caller
  /// @param source  where they come from, for messages
  ArchiveReader(std::string_view bytes, std::string source) : rest_(bytes), source_(std::move(source)) {}

  /// @throws InputError when the bytes end before, or a length in them cannot be
  template <class... Ts>
  void operator()(Ts&... values) {
    (get(values), ...);
  }
  bool at_end() const { return rest_.empty(); }

 private:
  [[noreturn]] void fail() const { throw InputError(source_ + ": the data is damaged: it ends too early"); }
  void get_raw(void* data, std::size_t size) {
    if (rest_.size() < size) fail();
    if (size > 0) std::memcpy(data, rest_.data(), size);
    rest_.remove_prefix(size);
  }
  // Every element takes a byte at least, so that no length can ask for more memory than the data justifies.
  std::size_t get_length(std::size_t bytes_per_element) {
    std::uint64_t length = 0;
    get(length);
    if (length > rest_.size() / bytes_per_element) fail();
    return length;
  }
  template <PlainNumber T>
  void get(T& value) {
    get_raw(&value, sizeof(T));
  }
  void get(bool& value) {
    std::uint8_t byte = 0;
    get(byte);
    value = byte != 0;
  }
  template <class T>
  void get(std::vector<T>& values) {
    if constexpr (PlainNumber<T>) {
      values.resize(get_length(sizeof(T)));
      get_raw(values.data(), values.size() * sizeof(T));
    } else {
      values.assign(get_length(1), T());
      for (T& value : values) get(value);
    }
  }
  template <class T>
  void get(std::deque<T>& values) {
    values.assign(get_length(1), T());
    for (T& value : values) get(value);
  }
  template <class A, class B>
  void get(std::pair<A, B>& pair) {
    (*this)(pair.first, pair.second);
  }
  template <KeyedMap T>
  void get(T& values) {
    values.clear();
    for (std::size_t i = get_length(1); i > 0; --i) {
      std::pair<typename T::key_type, typename T::mapped_type> entry;
      get(entry);
      values.insert(std::move(entry));
    }
  }
  template <KeySet T>
  void get(T& values) {
    values.clear();
    for (std::size_t i = get_length(1); i > 0; --i) {
      typename T::key_type key;
      get(key);
      values.insert(std::move(key));
    }
  }
  void get(std::string& text) {
    text.resize(get_length(1));
    get_raw(text.data(), text.size());
  }
  template <class T, std::size_t N>
  void get(std::array<T, N>& values) {
    if constexpr (PlainNumber<T>) {
      get_raw(values.data(), sizeof(values));
    } else {
      for (T& value : values) get(value);
    }
  }
  template <class T, std::size_t N>
  void get(T (&values)[N]) {
    for (T& value : values) get(value);
  }
  template <class T>
  void get(std::optional<T>& value) {
    bool present = false;
    get(present);
    value.reset();
    if (present) get(value.emplace());
  }
  template <class T, int Rows, int Cols, int Options>
  void get(Eigen::Matrix<T, Rows, Cols, Options>& matrix) {
    get_raw(matrix.data(), sizeof(T) * Rows * Cols);
  }
  void get(Eigen::Quaterniond& rotation) { get(rotation.coeffs()); }
  template <class T>
  requires requires(T& value, ArchiveReader& reader) { T::archive(value, reader); }
  void get(T& value) { T::archive(value, *this); }

  std::string_view rest_;
  std::string source_;
};

}  // namespace mlo
