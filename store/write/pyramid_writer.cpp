#include "store/write/pyramid_writer.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "store/base/error.hpp"

namespace teracell::inline store {

LevelChunk encode_level(ChunkEncoder& encoder, const Metadata& meta, int level, uint32_t cu, uint32_t cv, const Chunk& rays) {
  LevelChunk out{level, cu, cv, {}};
  const LevelShape shape(meta, level);
  if (shape.segments == 1) {
    out.segments.push_back(encode_chunk(encoder, rays.rays, rays.sets, level == 0));
    return out;
  }
  const SegmentCutter cutter(rays.rays);
  for (uint32_t s = 0; s < shape.segments; ++s) {
    const uint32_t from = s * shape.chunk_cells;
    out.segments.push_back(encode_chunk(encoder, cutter.cut(from, from + shape.length(s)), rays.sets, level == 0));
  }
  return out;
}

Chunk join_pieces(const Chunk* pieces, uint32_t side, uint32_t stride, uint32_t chunk_rays, uint32_t labels) {
  std::vector<Piece> places;
  for (uint32_t v = 0; v < side; ++v)
    for (uint32_t u = 0; u < side; ++u)
      if (const Chunk& piece = pieces[v * stride + u]; piece.rays.rays() != 0)
        places.push_back({u * (chunk_rays / side), v * (chunk_rays / side), 0, &piece});
  return places.empty() ? Chunk() : join(places, labels);
}

namespace {

uint32_t child_at(uint32_t u, uint32_t v) { return v % kFanOut * kFanOut + u % kFanOut; }
uint32_t quarter_of(uint32_t child) { return child / (2 * kFanOut) * 2 + child % kFanOut / 2; }

}  // namespace

PyramidNode::PyramidNode(const Metadata& meta, int level, uint32_t u, uint32_t v, bool whole, std::shared_ptr<PyramidNode> above)
    : meta_(meta), level_(level), u_(u), v_(v), whole_(whole), above_(std::move(above)) {
  const LevelShape below(meta, level);
  const uint32_t nu = std::min(kFanOut, below.chunks_u - u * kFanOut), nv = std::min(kFanOut, below.chunks_v - v * kFanOut);
  unput_ = nu * nv;
  for (uint32_t j = 0; j < nv; ++j)
    for (uint32_t i = 0; i < nu; ++i) ++missing_[quarter_of(child_at(i, j))];
  for (const auto& missing : missing_) quarters_left_ += missing > 0;
}

void PyramidNode::add(uint32_t cu, uint32_t cv, Chunk coarsened, ChunkEncoder& encoder) {
  const uint32_t at = child_at(cu, cv), q = quarter_of(at);
  if (children_[at].rays.rays() != 0) throw FormatError(fmt::format("level {} chunk ({}, {}): it is there twice", level_, cu, cv));
  children_[at] = std::move(coarsened);
  if (--missing_[q] > 0 || !whole_) return;
  try {
    make_quarter(q, encoder);
  } catch (...) {
    failed_[q] = std::current_exception();  // thrown with the last quarter, so that of several it is always the same one
  }
  if (--quarters_left_ == 0) make_even(encoder);
}

void PyramidNode::make_quarter(uint32_t q, ChunkEncoder& encoder) {
  const auto labels = static_cast<uint32_t>(meta_.labels.size());
  const Chunk rays = join_pieces(&children_[size_t{2} * (q / 2 * kFanOut + q % 2)], 2, kFanOut, meta_.chunk_rays, labels);
  if (rays.rays.rays() == 0) return;
  odd_[q] = encode_level(encoder, meta_, level_ + 1, u_ * 2 + q % 2, v_ * 2 + q / 2, rays);
  if (level_ + 2 < meta_.grid.levels()) quarters_[q] = coarsen(rays, 1);
}

void PyramidNode::make_even(ChunkEncoder& encoder) {
  for (const std::exception_ptr& failed : failed_)
    if (failed) std::rethrow_exception(failed);
  for (uint32_t q = 0; q < 4; ++q)  // those whose children were all made before the run was resumed
    if (odd_[q].segments.empty()) make_quarter(q, encoder);
  if (level_ + 2 >= meta_.grid.levels()) return;
  const Chunk rays = join_pieces(quarters_.data(), 2, 2, meta_.chunk_rays, static_cast<uint32_t>(meta_.labels.size()));
  quarters_ = {};
  even_ = encode_level(encoder, meta_, level_ + 2, u_, v_, rays);
  if (above_) above_->add(u_, v_, coarsen(rays, 1), encoder);
}

PyramidWriter::PyramidWriter(ChunkSink& sink, const TreeRange& range)
    : sink_(sink), range_(range), path_(sink.meta().grid.levels() / 2), restored_(path_.size()) {}

std::shared_ptr<PyramidNode> PyramidWriter::node_above(int level, uint32_t cu, uint32_t cv) {
  if (level + 1 >= sink_.meta().grid.levels()) return nullptr;
  std::shared_ptr<PyramidNode>& node = path_[level / 2 - 1];
  const uint32_t u = cu / kFanOut, v = cv / kFanOut;
  if (node && node->u_ == u && node->v_ == v) return node;
  node.reset(new PyramidNode(sink_.meta(), level, u, v, range_.has_all(level / 2, u, v), node_above(level + 2, u, v)));
  auto& before = restored_[level / 2 - 1];
  for (uint32_t i = 0; i < kChildren; ++i) {
    if (before[i].rays.rays() == 0) continue;
    node->children_[i] = std::exchange(before[i], {});
    node->put_[i] = true;
    --node->unput_;
    if (--node->missing_[quarter_of(i)] == 0) --node->quarters_left_;  // not to 0: a node whose children are all put is no longer saved
  }
  return node;
}

void PyramidWriter::put(const LevelChunk& chunk) {
  for (uint32_t s = 0; s < chunk.segments.size(); ++s) sink_.put({chunk.level, chunk.cu, chunk.cv, s}, chunk.segments[s]);
}

void PyramidWriter::put_above(const std::shared_ptr<PyramidNode>& first, uint32_t cu, uint32_t cv) {
  at_ = first;
  for (PyramidNode* node = first.get(); node; cu = node->u_, cv = node->v_, node = node->above_.get()) {
    if (!node->whole_) return sink_.put_child(node->level_, cu, cv, std::exchange(node->children_[child_at(cu, cv)], {}));
    node->put_[child_at(cu, cv)] = true;
    if (--node->unput_ > 0) return;
    for (const LevelChunk& chunk : node->odd_) put(chunk);
    put(node->even_);
  }
}

void PyramidWriter::save(Bytes& state) {
  ChunkEncoder encoder;
  const Chunk none;
  const PyramidNode* node = at_.get();
  for (size_t n = 0; n < path_.size(); ++n, node = node ? node->above_.get() : nullptr)
    for (uint32_t i = 0; i < kChildren; ++i) {
      const Chunk& child = node && node->whole_ && node->unput_ > 0 && node->put_[i] ? node->children_[i] : none;
      put_varint(state, child.rays.nu);
      if (child.rays.nu == 0) continue;
      put_varint(state, child.rays.nv);
      put_varint(state, child.rays.length);
      put_sized(state, encoder.encode(child.rays, child.sets));
    }
}

void PyramidWriter::restore(ByteReader& state) {
  const Metadata& meta = sink_.meta();
  ChunkDecoder decoder;
  for (auto& children : restored_)
    for (Chunk& child : children) {
      const auto nu = static_cast<uint32_t>(state.varint(0, meta.chunk_rays, "rays"));
      if (nu == 0) continue;
      const auto nv = static_cast<uint32_t>(state.varint(1, meta.chunk_rays, "rays"));
      const auto length = static_cast<uint32_t>(state.varint(1, Axis::kMaxCells, "cells"));
      decoder.decode(state.take_sized(), nu, nv, length, static_cast<uint32_t>(meta.labels.size()), child);
    }
}

}  // namespace teracell::store
