# SPDX-License-Identifier: MIT
#
# Reads a program's ELF file and fails if it is not hardened: cmake -D READELF=readelf -D BINARY=file -P check_hardened.cmake
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND ${READELF} --wide --file-header --program-headers --dynamic --dyn-syms ${BINARY}
  OUTPUT_VARIABLE elf COMMAND_ERROR_IS_FATAL ANY)

# expect(regex meaning): one property of the file.
function(expect regex meaning)
  if(NOT elf MATCHES "${regex}")
    message(SEND_ERROR "${BINARY}: ${meaning}")
  endif()
endfunction()
expect("Type: +DYN" "not position-independent (PIE)")
expect("GNU_RELRO" "no segment that becomes read-only (RELRO)")
expect("\\(FLAGS_1\\)[^\n]* NOW|\\(BIND_NOW\\)" "functions are looked up late, so RELRO is partial")
expect("GNU_STACK +0x[0-9a-f]+ 0x[0-9a-f]+ 0x[0-9a-f]+ 0x[0-9a-f]+ 0x[0-9a-f]+ RW " "the stack can be executed")
expect("__stack_chk_fail" "no stack protector")
expect("__[a-z]+_chk@" "no checked string functions (_FORTIFY_SOURCE)")
