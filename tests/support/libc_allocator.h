// SPDX-License-Identifier: MIT
//
// libc_allocator.h: glibc's allocator under its own names, for what replaces it by one that counts and refuses. Each
// replacement decides for itself what it counts and whom it refuses.
#pragma once

#include <cstddef>

extern "C" {
// NOLINTBEGIN: the C library's own names.
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);
// NOLINTEND
}
