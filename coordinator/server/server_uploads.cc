// Inputs that come in pieces: what core/uploads.h wants done, and what came of it.
#include <utility>

#include "coordinator/server/server.h"
#include "schema/text.h"

namespace cairn::coordinator {

void Server::Serve(const std::string& peer, const std::string& user, const wire::Offer& offer) {
  const Result<Hash> hash = Hash::FromBinary(offer.hash());
  if (!hash.ok()) return RefuseJob(peer, wire::RefusalKind::kBlob, hash.status().message());
  if (const std::uint64_t most = options_.largest_input_bytes; offer.bytes() > most)
    return RefuseJob(
        peer, wire::RefusalKind::kOversized,
        "an input of " + BytesText(offer.bytes()) + "; at most " + BytesText(most) + " are taken");
  if (const std::string full = use_.WhyNoRoom(offer.bytes()); !full.empty() && !HasOf(user, hash.value()))
    return RefuseAsUnable(peer, wire::RefusalKind::kStore, full);
  if (const std::string over = WhyNoMoreInputs(user, {}, offer.bytes()); !over.empty())
    return RefuseAsUnable(peer, wire::RefusalKind::kQuota, over);
  Carry(uploads_.Offered(peer, user, hash.value(), offer.bytes(), Now()));
}

void Server::Carry(Uploads::Actions actions) {
  for (UploadAction& action : actions) std::visit([this](auto& a) { Do(std::move(a)); }, action);
  for (const std::string& peer : std::exchange(gone_uploaders_, {})) Carry(uploads_.Lost(peer, Now()));
}

void Server::Do(OpenUpload open) { writer_.Add(open); }

void Server::Do(WritePiece piece) { writer_.Add(std::move(piece)); }

void Server::Do(CloseUpload close) {
  writer_.Add(close);
  if (!close.whole) RemoveUnknown(close.hash);
}

void Server::Do(const TellCredit& tell) {
  wire::Message message;
  *message.envelope.mutable_credit() = tell.credit;
  if (!transport_.Send(tell.peer, std::move(message))) gone_uploaders_.insert(tell.peer);
}

void Server::Do(const AnswerOffer& answer) {
  wire::Message message;
  wire::Reply& reply = *message.envelope.mutable_reply();
  reply.set_ok(answer.refusal.empty());
  reply.set_message(answer.refusal);
  reply.set_unable(answer.unable);
  if (answer.again) reply.add_missing(answer.hash.Binary());
  Reply(answer.peer, std::move(message));
}

void Server::Do(const ReleaseBlob& release) {
  if (core_.Holds(release.hash) || uploads_.Keeps(release.hash)) return;
  blobs_.Drop({release.hash});
  RemoveUnknown(release.hash);
}

void Server::Do(const DropUploader& drop) {
  refusals_.Add(drop.refusal, Now());
  transport_.Drop(drop.peer);
}

// What was dropped while a file of it was being made was left on disk then.
void Server::RemoveUnknown(const Hash& hash) {
  if (!blobs_.Has(hash) && !uploads_.Writing().contains(hash)) writer_.Add(RemoveBlobsWork{{hash}});
}

void Server::TakeUploadDone(const DiskDone& done) {
  if (!done.closed) return Carry(uploads_.Wrote(done.upload, done.upload_bytes, done.status, Now()));
  if (done.status.ok()) blobs_.AddDurable(done.blob);
  Carry(uploads_.Closed(done.upload, done.status, Now()));
  if (!done.status.ok()) RemoveUnknown(done.blob);
}

}  // namespace cairn::coordinator
