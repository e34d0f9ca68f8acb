#pragma once

#include <string_view>

namespace mlo {

/// config/networks/3dssd_small.safetensors, which is part of the library.
std::string_view embedded_network_weights();

}  // namespace mlo
