#include "mlo/pipeline/embedded_network.hpp"

#include <cstddef>

// The assembler puts the file into the object file, byte by byte; MLO_NETWORK_FILE is its path.
asm(R"(
.section .rodata
.balign 64
mlo_network_begin:
.incbin ")" MLO_NETWORK_FILE R"("
mlo_network_end:
.byte 0
.previous
)");

extern "C" {
extern const char mlo_network_begin[];
extern const char mlo_network_end[];
}

namespace mlo {

std::string_view embedded_network_weights() {
  return {mlo_network_begin, static_cast<std::size_t>(mlo_network_end - mlo_network_begin)};
}

}  // namespace mlo
