#pragma once

#include <filesystem>

#include "mlo/core/tensor_file.hpp"

namespace mlo {

/// Reads the safetensors format (github.com/huggingface/safetensors): the length of a header as 8 bytes, the
/// header as JSON, the numbers. Types F32, F16, BF16, F64 and I64 are taken and become float. What the header
/// says must fit the file exactly: no holes, no overlaps, no bytes left over.
/// @throws InputError naming the file, what is wrong in it and the remedy
TensorFile read_safetensors(const std::filesystem::path& path);

/// The same for bytes at hand.
/// @param place  what messages call them
TensorFile parse_safetensors(std::string_view bytes, const std::filesystem::path& place);

/// Writes F32 in little-endian order, by name. The same content gives the same bytes; the file appears whole
/// or not at all.
/// @throws InputError if a tensor has not as many values as its shape says, a text is not UTF-8, or the file
///   cannot be written
void write_safetensors(const std::filesystem::path& path, const TensorFile& file);

}  // namespace mlo
