#include "coordinator/store/upload_files.h"

#include <span>
#include <string>
#include <utility>

namespace cairn::coordinator {

Status UploadFiles::Do(const OpenUpload& open) {
  File& file = files_[open.id];
  file.status = folder_.IsStillThere();
  if (file.status.ok()) file.status = use_.Reserve(open.bytes);
  if (!file.status.ok()) return file.status;
  Result<FlatFileWriter> writer =
      FlatFileWriter::Create(folder_.Uploads() / (std::to_string(open.id) + ".part"), open.hash);
  if (writer.ok())
    file.writer.emplace(std::move(writer).value());
  else
    file.status = writer.status();
  return file.status;
}

Status UploadFiles::Do(const WritePiece& piece) {
  File& file = files_.at(piece.id);
  if (!file.writer) return file.status;
  file.status = file.writer->Write(std::as_bytes(std::span(piece.data)));
  if (!file.status.ok()) file.writer.reset();
  return file.status;
}

Status UploadFiles::Do(const CloseUpload& close) {
  File file = std::move(files_.extract(close.id).mapped());
  if (!close.whole || !file.writer) return file.status;
  return file.writer->Publish(folder_.FlatFile(close.hash));
}

}  // namespace cairn::coordinator
