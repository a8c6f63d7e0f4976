// Makes of a good log and a good result, both Cairn's, files as a stranger, or a disk, would hand them in.
//   foreign_files LOG.h5 RESULT.h5 FOLDER
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "schema/store/blob_file.h"

namespace {

namespace fs = std::filesystem;
using cairn::Array;
using cairn::Blob;
using cairn::BlobFile;

void Write(const fs::path& path, const std::string& kind, const Blob& blob) {
  if (!cairn::WriteBlobFile(path, kind, blob).ok()) throw cairn::InputError("cannot write " + path.string());
}

std::string Bytes(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Names of robots, datasets and kinds that a terminal obeys, and that are none.
void WriteNames(const BlobFile& file, const std::string& stem) {
  using namespace std::string_literals;
  const std::string names[] = {"\x1b[2J\x1b]0;owned\x07"s,
                               "R\xf6sa"s,
                               "a\0b"s,
                               "\xc2\x9b"
                               "31m"s,
                               "two\nlines"s,
                               "\xe2\x80\xae"
                               "desrever"s,
                               std::string(5000, 'a')};
  for (std::size_t k = 0; k < std::size(names); ++k) {
    Blob robot = file.blob, dataset = file.blob, text = file.blob;
    robot.Put("robots",
              Array::FromBytes(cairn::DType::kText, names[k].size(), {1}, std::as_bytes(std::span(names[k])))
                  .value());
    Write(stem + "-robot-" + std::to_string(k) + ".h5", file.kind, robot);
    text.Put("provenance/note", Array::Texts({names[k]}));
    Write(stem + "-text-" + std::to_string(k) + ".h5", file.kind, text);
    if (names[k].find('\0') != std::string::npos) continue;
    dataset.PutVector<double>("robot/0/" + names[k], {1});
    Write(stem + "-dataset-" + std::to_string(k) + ".h5", file.kind, dataset);
    Write(stem + "-kind-" + std::to_string(k) + ".h5", names[k], file.blob);
  }
}

// The first 0 or -1 of an array of indices turned into the other, as Fletcher-32 does not see.
void WriteFlipped(const fs::path& from, const BlobFile& file, const fs::path& to) {
  const auto landmark = file.blob.Get<std::int32_t>("robot/0/observations/map_landmark");
  std::string bytes = Bytes(from);
  const std::string_view needle(reinterpret_cast<const char*>(landmark.data()), landmark.size_bytes());
  const std::size_t at = bytes.find(needle);
  const auto which = std::ranges::find_if(landmark, [](std::int32_t k) { return k == 0 || k == -1; });
  if (at == std::string::npos || which == landmark.end()) throw cairn::InputError("there is nothing to flip");
  for (std::size_t k = 0; k < 4; ++k) {
    char& byte = bytes[at + static_cast<std::size_t>(which - landmark.begin()) * 4 + k];
    byte = static_cast<char>(~byte);
  }
  std::ofstream(to, std::ios::binary) << bytes;
}

// Without its checksum trailer, as HDF5 leaves a file that a program has changed through it.
void WriteWithoutTrailer(const fs::path& from, const fs::path& to) {
  constexpr std::size_t kTrailer = 24;
  std::string bytes = Bytes(from);
  bytes.resize(bytes.size() - kTrailer);
  std::ofstream(to, std::ios::binary) << bytes;
}

BlobFile Read(const fs::path& path) {
  cairn::Result<BlobFile> file = cairn::ReadBlobFile(path);
  if (!file.ok()) throw cairn::InputError(file.status().message());
  return std::move(file).value();
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 4) return std::fputs("foreign_files LOG.h5 RESULT.h5 FOLDER\n", stderr), 2;
  const fs::path log = argv[1], result = argv[2], folder = argv[3];
  fs::create_directories(folder);
  WriteNames(Read(log), (folder / "log").string());
  WriteNames(Read(result), (folder / "result").string());
  WriteFlipped(result, Read(result), folder / "flipped.h5");
  WriteWithoutTrailer(result, folder / "changed.h5");
  WriteWithoutTrailer(log, folder / "changed-log.h5");
  Write(folder / "column.h5", "log", Read(log).blob.Without("robot/0/odometry/forward_m"));
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
