# MLO_SANITIZE: a comma-separated list for -fsanitize, for instance "address,undefined" or "thread".
set(MLO_SANITIZE "" CACHE STRING "Sanitizers to build with: address,undefined or thread")
if(MLO_SANITIZE)
  add_library(mlo_sanitizers INTERFACE)
  target_compile_options(mlo_sanitizers INTERFACE -fsanitize=${MLO_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=all)
  target_link_options(mlo_sanitizers INTERFACE -fsanitize=${MLO_SANITIZE})
endif()
