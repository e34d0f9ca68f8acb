#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace mlo {

/// The lines of a text file, without their ends (also \r); blank lines at its end are left out.
/// @throws InputError if the file cannot be read
std::vector<std::string> read_lines(const std::filesystem::path& file);

/// The numbers of a line, separated by blanks.
/// @param where  file and line, for the message
/// @throws InputError if something in it is not a finite number
std::vector<double> parse_numbers(std::string_view line, std::string_view where);

/// Seconds from a number ("12.5") or since 1970 from a date ("2011-09-26 13:04:32.335337762").
/// @param where  file and line, for the message
/// @throws InputError if it is neither
double parse_stamp_s(std::string_view text, std::string_view where);

/// One stamp per line; NaN where the line is blank (KITTI's way to say that a frame is missing).
std::vector<double> read_stamps_s(const std::filesystem::path& file);

}  // namespace mlo
