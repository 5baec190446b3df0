// Numbers and a JSON text as one block of a report: deflated, in base64.
#ifndef MJCF_PDG_APPS_HTML_PACKED_H_
#define MJCF_PDG_APPS_HTML_PACKED_H_

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace mjcf_pdg::app {

// The block that `unpack` in web/packed.js takes apart: the text's length (32 bits), the text, then
// `bytes` (little endian, as they lie in memory).
std::string Pack(const nlohmann::ordered_json& json, std::string_view bytes);

// The bytes of an array of numbers.
template <typename Array>
std::string_view BytesOf(const Array& array) {
  return {reinterpret_cast<const char*>(array.data()), array.size() * sizeof(array[0])};
}

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_HTML_PACKED_H_
