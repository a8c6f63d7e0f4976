#include "datasets/bag/unpack.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <memory>

#include "datasets/bag/window_file.h"
#include "schema/text.h"

namespace cairn::datasets::bag {
namespace {

// What comes out of a decoder: room for more of it, but for no more than there may be.
class Sink {
 public:
  Sink(std::vector<std::byte>* buffer, std::uint64_t most) : buffer_(*buffer), most_(most) {}
  // One byte more than there may be, so that it is seen.
  std::span<std::byte> Room() {
    constexpr std::size_t kFirstBytes = 1 << 16;
    if (filled_ == buffer_.size() && filled_ <= most_)
      buffer_.resize(std::min<std::uint64_t>(std::max(kFirstBytes, 2 * filled_), most_ + 1));
    return std::span(buffer_).subspan(filled_);
  }
  void Add(std::size_t count) {
    filled_ += count;
    if (filled_ > most_) throw Damage{"a packed chunk unpacks to more than it says"};
  }
  ByteSpan bytes() const { return ByteSpan(buffer_).first(filled_); }

 private:
  std::vector<std::byte>& buffer_;
  std::uint64_t most_;
  std::size_t filled_ = 0;
};

void UnpackLz4(ByteSpan packed, Sink* sink) {
  LZ4F_dctx* made = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION)) != 0) throw std::bad_alloc();
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(
      made, LZ4F_freeDecompressionContext);
  for (std::size_t left = 1; left != 0;) {
    const std::span<std::byte> room = sink->Room();
    std::size_t written = room.size(), taken = packed.size();
    left = LZ4F_decompress(context.get(), room.data(), &written, packed.data(), &taken, nullptr);
    if (LZ4F_isError(left) != 0)
      throw Damage{std::string("a chunk is no lz4, or damaged: ") + LZ4F_getErrorName(left)};
    if (left != 0 && written == 0 && taken == 0) throw Damage{"a chunk of lz4 is cut short"};
    packed = packed.subspan(taken);
    sink->Add(written);
  }
}

void UnpackStreamOfZstd(ByteSpan packed, Sink* sink) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), ZSTD_freeDCtx);
  if (!context) throw std::bad_alloc();
  ZSTD_inBuffer in{packed.data(), packed.size(), 0};
  for (std::size_t left = 1; left != 0 || in.pos < in.size;) {
    const std::span<std::byte> room = sink->Room();
    ZSTD_outBuffer out{room.data(), room.size(), 0};
    const std::size_t before = in.pos;
    left = ZSTD_decompressStream(context.get(), &out, &in);
    if (ZSTD_isError(left) != 0)
      throw Damage{std::string("a chunk is no zstd, or damaged: ") + ZSTD_getErrorName(left)};
    if (left != 0 && out.pos == 0 && in.pos == before) throw Damage{"a chunk of zstd is cut short"};
    sink->Add(out.pos);
  }
}

void UnpackBz2(ByteSpan packed, Sink* sink) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) throw std::bad_alloc();
  const std::unique_ptr<bz_stream, decltype(&BZ2_bzDecompressEnd)> end(&stream, BZ2_bzDecompressEnd);
  // The library writes to no byte of what it reads.
  stream.next_in = const_cast<char*>(reinterpret_cast<const char*>(packed.data()));
  stream.avail_in = static_cast<unsigned>(packed.size());
  for (int code = BZ_OK; code != BZ_STREAM_END;) {
    const std::span<std::byte> room = sink->Room();
    stream.next_out = reinterpret_cast<char*>(room.data());
    stream.avail_out = static_cast<unsigned>(room.size());
    const unsigned before = stream.avail_in;
    code = BZ2_bzDecompress(&stream);
    if (code != BZ_OK && code != BZ_STREAM_END) throw Damage{"a chunk is no bz2, or damaged"};
    const std::size_t written = room.size() - stream.avail_out;
    if (code == BZ_OK && written == 0 && stream.avail_in == before)
      throw Damage{"a chunk of bz2 is cut short"};
    sink->Add(written);
  }
}

}  // namespace

ByteSpan Unpacker::Unpack(const std::string& how, ByteSpan packed, std::uint64_t size) {
  if (IsPlain(how)) return packed;
  if (size > kMostRecordBytes)
    throw Damage{"a chunk of " + std::to_string(size >> 20) + " MB, where " +
                 std::to_string(kMostRecordBytes >> 20) + " MB are allowed"};
  Sink sink(&buffer_, size);
  if (how == "lz4")
    UnpackLz4(packed, &sink);
  else if (how == "zstd")
    UnpackStreamOfZstd(packed, &sink);
  else if (how == "bz2")
    UnpackBz2(packed, &sink);
  else
    throw Damage{"a chunk packed as '" + Printable(how, 40) + "'; known are bz2, lz4 and zstd"};
  if (sink.bytes().size() != size) throw Damage{"a packed chunk unpacks to less than it says"};
  return sink.bytes();
}

ByteSpan Unpacker::UnpackZstd(ByteSpan packed) {
  Sink sink(&buffer_, kMostRecordBytes);
  UnpackStreamOfZstd(packed, &sink);
  return sink.bytes();
}

}  // namespace cairn::datasets::bag
