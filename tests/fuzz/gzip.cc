#include "tests/fuzz/gzip.h"

#include <zlib.h>

#include "schema/error.h"

namespace cairn::fuzz {

std::string Gzip(std::string_view text) {
  constexpr int kGzipWindow = 15 + 16;  // zlib.h: 16 more than the window's bits make it a gzip stream
  z_stream stream{};
  CAIRN_DEMAND(deflateInit2(&stream, 1, Z_DEFLATED, kGzipWindow, 8, Z_DEFAULT_STRATEGY) == Z_OK, "no zlib");
  std::string zipped(deflateBound(&stream, text.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));  // zlib only reads it
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(zipped.data());
  stream.avail_out = static_cast<uInt>(zipped.size());
  CAIRN_DEMAND(deflate(&stream, Z_FINISH) == Z_STREAM_END, "zlib cannot");
  zipped.resize(stream.total_out);
  deflateEnd(&stream);
  return zipped;
}

}  // namespace cairn::fuzz
