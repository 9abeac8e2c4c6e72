#include "tests/network/unruly.h"

#include <dlfcn.h>

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

// Two functions of the library's permissions stand here in its place: a definition in the program
// goes before the library's own. Their names as the compiler writes them, since no header has them.
#define MORTISE_WRITER_CHECK                                                                    \
  "_ZN8eprosima8fastrtps4rtps8security11Permissions23check_create_datawriterERKNS2_"            \
  "6HandleEjRKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEERKSt6vectorISC_SaISC_EERNS2_" \
  "17SecurityExceptionE"
#define MORTISE_READER_CHECK                                                                    \
  "_ZN8eprosima8fastrtps4rtps8security11Permissions23check_create_datareaderERKNS2_"            \
  "6HandleEjRKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEERKSt6vectorISC_SaISC_EERNS2_" \
  "17SecurityExceptionE"

namespace {

std::atomic<bool> unruly{false};

using Partitions = std::vector<std::string>;
using Check = bool (*)(void*, const void*, std::uint32_t, const std::string&, const Partitions&,
                       void*);

bool ask_library(const char* name, void* self, const void* handle, std::uint32_t domain,
                 const std::string& topic, const Partitions& partitions, void* exception) {
  if (unruly) return true;
  const auto check = reinterpret_cast<Check>(dlsym(RTLD_NEXT, name));
  return check != nullptr && check(self, handle, domain, topic, partitions, exception);
}

}  // namespace

bool check_writer(void* self, const void* handle, std::uint32_t domain, const std::string& topic,
                  const Partitions& partitions, void* exception) __asm__(MORTISE_WRITER_CHECK);
bool check_writer(void* self, const void* handle, std::uint32_t domain, const std::string& topic,
                  const Partitions& partitions, void* exception) {
  return ask_library(MORTISE_WRITER_CHECK, self, handle, domain, topic, partitions, exception);
}
bool check_reader(void* self, const void* handle, std::uint32_t domain, const std::string& topic,
                  const Partitions& partitions, void* exception) __asm__(MORTISE_READER_CHECK);
bool check_reader(void* self, const void* handle, std::uint32_t domain, const std::string& topic,
                  const Partitions& partitions, void* exception) {
  return ask_library(MORTISE_READER_CHECK, self, handle, domain, topic, partitions, exception);
}

namespace mortise::test {

Unruly::Unruly() { unruly = true; }
Unruly::~Unruly() { unruly = false; }

}  // namespace mortise::test
