#include "mlo/io/safetensors.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "mlo/core/error.hpp"
#include "mlo/io/atomic_file.hpp"
#include "mlo/io/scalar.hpp"
#include "mlo/io/text.hpp"

namespace mlo {
namespace {

using nlohmann::json;

constexpr std::size_t kLengthBytes = 8;
constexpr std::uint64_t kMaxHeaderBytes = 100'000'000;  // the format's own limit
constexpr std::size_t kAlignment = 8;  // of the numbers, as other programs that write it keep
constexpr const char* kMetadata = "__metadata__";

[[noreturn]] void refuse(const std::filesystem::path& path, std::string_view problem) {
  throw InputError(
      fmt::format("{}: {}; copy the file again, or write it anew with what made it", path.string(), problem));
}

float half_to_float(std::uint16_t half) {
  const float sign = (half & 0x8000U) != 0 ? -1.0F : 1.0F;
  const int exponent = half >> 10U & 0x1F;
  const auto fraction = static_cast<float>(half & 0x3FFU);
  if (exponent == 0) return sign * std::ldexp(fraction, -24);
  if (exponent < 31) return sign * std::ldexp(1024.0F + fraction, exponent - 25);
  return fraction == 0.0F ? sign * std::numeric_limits<float>::infinity()
                          : std::numeric_limits<float>::quiet_NaN();
}

/// How a type of the format is stored.
struct ElementType {
  std::string_view name;
  std::size_t bytes;
  float (*load)(const char*);
};

constexpr std::endian kOrder = std::endian::little;
const ElementType kElementTypes[] = {
    {"F32", 4, [](const char* bytes) { return load<float>(bytes, kOrder); }},
    {"F16", 2, [](const char* bytes) { return half_to_float(load<std::uint16_t>(bytes, kOrder)); }},
    {"BF16", 2,
     [](const char* bytes) {
       return std::bit_cast<float>(std::uint32_t{load<std::uint16_t>(bytes, kOrder)} << 16U);
     }},
    {"F64", 8, [](const char* bytes) { return static_cast<float>(load<double>(bytes, kOrder)); }},
    {"I64", 8, [](const char* bytes) { return static_cast<float>(load<std::int64_t>(bytes, kOrder)); }},
};

/// The header as it stands in the file; of a name that stands twice JSON parsers keep one and say nothing.
json parse_header(const std::filesystem::path& path, std::string_view text) {
  std::vector<std::set<std::string>> names;
  std::optional<std::string> repeated;
  const auto watch = [&](int, json::parse_event_t event, const json& value) {
    if (event == json::parse_event_t::object_start) names.emplace_back();
    if (event == json::parse_event_t::object_end) names.pop_back();
    if (event == json::parse_event_t::key && !names.back().insert(value.get<std::string>()).second) {
      repeated = value.get<std::string>();
    }
    return true;
  };
  json header;
  try {
    header = json::parse(text, watch);
  } catch (const json::exception& error) {
    refuse(path, fmt::format("its header is not JSON ({})", error.what()));
  }
  if (repeated) refuse(path, fmt::format("'{}' stands twice in its header", *repeated));
  if (!header.is_object()) refuse(path, "its header is no JSON object");
  return header;
}

std::map<std::string, std::string> parse_metadata(const std::filesystem::path& path, const json& entries) {
  if (!entries.is_object()) refuse(path, fmt::format("{} is no JSON object", kMetadata));
  std::map<std::string, std::string> metadata;
  for (const auto& [name, value] : entries.items()) {
    if (!value.is_string()) refuse(path, fmt::format("{} '{}' is no text", kMetadata, name));
    metadata.emplace(name, value.get<std::string>());
  }
  return metadata;
}

/// Non-negative whole numbers; nothing for anything else.
std::optional<std::vector<std::uint64_t>> counts_of(const json& entry, const char* key) {
  const auto found = entry.find(key);
  if (found == entry.end() || !found->is_array()) return std::nullopt;
  std::vector<std::uint64_t> counts;
  for (const json& number : *found) {
    if (!number.is_number_unsigned()) return std::nullopt;
    counts.push_back(number.get<std::uint64_t>());
  }
  return counts;
}

/// Number of elements; nothing if there would be more than `limit`.
std::optional<std::uint64_t> product_within(const std::vector<std::uint64_t>& shape, std::uint64_t limit) {
  std::uint64_t product = 1;
  if (std::ranges::find(shape, 0U) != shape.end()) return 0;
  for (const std::uint64_t size : shape) {
    if (size > limit / product) return std::nullopt;
    product *= size;
  }
  return product;
}

/// Which of the file's numbers belong to a tensor.
struct Range {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
  std::string name;
};

Tensor parse_tensor(const std::filesystem::path& path, const std::string& name, const json& entry,
                    std::string_view data, std::vector<Range>& ranges) {
  const auto shape = counts_of(entry, "shape");
  const auto offsets = counts_of(entry, "data_offsets");
  if (!shape) refuse(path, fmt::format("tensor '{}' has no shape of whole numbers", name));
  if (!offsets || offsets->size() != 2)
    refuse(path, fmt::format("tensor '{}' has no two data_offsets", name));
  const std::string type_name = entry.value("dtype", json()).is_string() ? entry["dtype"] : "";
  const auto* const type = std::ranges::find(kElementTypes, type_name, &ElementType::name);
  if (type == std::end(kElementTypes)) {
    throw InputError(fmt::format(
        "{}: tensor '{}' is of type '{}'; F32, F16, BF16, F64 and I64 can be read: convert it to one of them",
        path.string(), name, type_name));
  }
  const std::uint64_t begin = (*offsets)[0];
  const std::uint64_t end = (*offsets)[1];
  if (begin > end || end > data.size()) {
    refuse(path, fmt::format("tensor '{}' lies at bytes {} to {} of {}; the file may be cut off", name, begin,
                             end, data.size()));
  }
  const auto count = product_within(*shape, data.size() / type->bytes);
  if (!count || *count * type->bytes != end - begin) {
    refuse(path,
           fmt::format("tensor '{}' has {} bytes, which is not what its shape needs", name, end - begin));
  }
  Tensor tensor{{shape->begin(), shape->end()}, std::vector<float>(*count)};
  for (std::size_t i = 0; i < *count; ++i) tensor.values[i] = type->load(&data[begin + i * type->bytes]);
  ranges.push_back({begin, end, name});
  return tensor;
}

/// No holes, no overlaps, nothing left over.
void check_ranges(const std::filesystem::path& path, std::vector<Range>& ranges, std::uint64_t size) {
  std::ranges::sort(ranges, {}, [](const Range& range) { return std::pair(range.begin, range.end); });
  std::uint64_t reached = 0;
  for (const Range& range : ranges) {
    if (range.begin < reached) refuse(path, fmt::format("tensor '{}' overlaps another", range.name));
    if (range.begin > reached) {
      refuse(path, fmt::format("bytes {} to {} belong to no tensor", reached, range.begin));
    }
    reached = range.end;
  }
  if (reached != size) refuse(path, fmt::format("{} bytes too many at its end", size - reached));
}

bool fits_its_shape(const Tensor& tensor) {
  if (std::ranges::any_of(tensor.shape, [](std::int64_t size) { return size < 0; })) return false;
  return product_within({tensor.shape.begin(), tensor.shape.end()}, tensor.values.size()) ==
         tensor.values.size();
}

std::string header_of(const std::filesystem::path& path, const TensorFile& file) {
  json header = json::object();
  if (!file.metadata.empty()) header[kMetadata] = file.metadata;
  std::uint64_t offset = 0;
  for (const auto& [name, tensor] : file.tensors) {
    if (name == kMetadata || !fits_its_shape(tensor)) {
      throw InputError(fmt::format("{}: tensor '{}' has {} values, which is not what its shape says",
                                   path.string(), name, tensor.values.size()));
    }
    const std::uint64_t end = offset + tensor.values.size() * sizeof(float);
    header[name] = {{"dtype", "F32"}, {"shape", tensor.shape}, {"data_offsets", {offset, end}}};
    offset = end;
  }
  try {
    std::string text = header.dump();
    text.resize((text.size() + kAlignment - 1) / kAlignment * kAlignment, ' ');
    return text;
  } catch (const json::exception&) {
    throw InputError(fmt::format("{}: a name or metadata text is not UTF-8", path.string()));
  }
}

}  // namespace

TensorFile read_safetensors(const std::filesystem::path& path) {
  return parse_safetensors(read_file(path), path);
}

TensorFile parse_safetensors(std::string_view bytes, const std::filesystem::path& path) {
  if (bytes.size() < kLengthBytes)
    refuse(path, fmt::format("has {} bytes, too few for safetensors", bytes.size()));
  const auto length = load<std::uint64_t>(bytes.data(), kOrder);
  if (length > kMaxHeaderBytes || length > bytes.size() - kLengthBytes) {
    refuse(path,
           fmt::format("says that its header has {} bytes, but {} follow; it is cut off or not safetensors",
                       length, bytes.size() - kLengthBytes));
  }
  const std::string_view content = bytes.substr(kLengthBytes);
  const json header = parse_header(path, content.substr(0, length));
  const std::string_view data = content.substr(length);
  TensorFile file;
  std::vector<Range> ranges;
  for (const auto& [name, entry] : header.items()) {
    if (name == kMetadata) {
      file.metadata = parse_metadata(path, entry);
    } else {
      if (!entry.is_object()) refuse(path, fmt::format("tensor '{}' is no JSON object", name));
      file.tensors.emplace(name, parse_tensor(path, name, entry, data, ranges));
    }
  }
  check_ranges(path, ranges, data.size());
  return file;
}

void write_safetensors(const std::filesystem::path& path, const TensorFile& file) {
  const std::string header = header_of(path, file);
  AtomicFile out(path);
  std::string bytes;
  append_uint32(bytes, static_cast<std::uint32_t>(header.size()));
  append_uint32(bytes, 0);  // headers stay far below 4 GB
  out.write(bytes);
  out.write(header);
  for (const auto& [name, tensor] : file.tensors) {
    bytes.clear();
    for (const float value : tensor.values) append_float32(bytes, value);
    out.write(bytes);
  }
  out.commit();
}

}  // namespace mlo
