#include "data/log/blob_bytes.h"

#include <memory>

#include <fmt/format.h>
#include <zstd.h>

namespace jnd {

namespace {
constexpr int kCompressionLevel = 3;  // zstd's default: a higher one saves 2 % and costs tenfold
}  // namespace

StorageError unreadable_blob(std::string_view why) {
  return StorageError(fmt::format("the telemetry cannot be read: {}", why));
}

std::string compressed_blob(std::string_view raw) {
  const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(ZSTD_createCCtx(), &ZSTD_freeCCtx);
  if (!context) throw StorageError("there is too little memory to compress the telemetry");
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, kCompressionLevel);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);
  std::string bytes(ZSTD_compressBound(raw.size()), '\0');
  const std::size_t size = ZSTD_compress2(context.get(), bytes.data(), bytes.size(), raw.data(), raw.size());
  if (ZSTD_isError(size))
    throw StorageError(fmt::format("the telemetry could not be compressed: {}", ZSTD_getErrorName(size)));
  bytes.resize(size);
  return bytes;
}

std::string blob_beginning(std::string_view bytes, std::size_t size) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), &ZSTD_freeDCtx);
  if (!context) throw unreadable_blob("there is too little memory");
  std::string out(size, '\0');
  ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
  ZSTD_outBuffer piece{out.data(), out.size(), 0};
  while (piece.pos < piece.size) {
    const std::size_t before = in.pos, had = piece.pos;
    const std::size_t left = ZSTD_decompressStream(context.get(), &piece, &in);
    if (ZSTD_isError(left)) throw unreadable_blob(ZSTD_getErrorName(left));
    if (left == 0 || (in.pos == before && piece.pos == had)) break;
  }
  out.resize(piece.pos);
  return out;
}

std::string decompressed_blob(std::string_view bytes, std::size_t largest) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), &ZSTD_freeDCtx);
  if (!context) throw unreadable_blob("there is too little memory");
  std::string out, chunk(ZSTD_DStreamOutSize(), '\0');
  ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
  for (;;) {
    ZSTD_outBuffer piece{chunk.data(), chunk.size(), 0};
    const std::size_t before = in.pos;
    const std::size_t left = ZSTD_decompressStream(context.get(), &piece, &in);
    if (ZSTD_isError(left)) throw unreadable_blob(ZSTD_getErrorName(left));
    out.append(chunk, 0, piece.pos);
    if (out.size() > largest) throw unreadable_blob("it is larger than any telemetry");
    if (left == 0) break;
    if (piece.pos == 0 && in.pos == before) throw unreadable_blob("its end is missing");
  }
  if (in.pos != in.size) throw unreadable_blob("it goes on behind its end");
  return out;
}

}  // namespace jnd
