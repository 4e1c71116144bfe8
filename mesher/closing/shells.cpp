#include "mesher/closing/shells.hpp"

#include <algorithm>

namespace teracell::mesher {
namespace {

// The memory that a facet of a batch takes at worst: when it shares none of its three vertices.
constexpr uint64_t kBytesInBatch = 160;

// So many that each bucket is sorted within the processor's cache.
size_t buckets_for(uint64_t records) { return static_cast<size_t>(std::bit_ceil(std::clamp<uint64_t>(records >> 14, 1, 4096))); }

template <class Record>
size_t bucket_of(const Buckets<Record>& buckets, const VertexHash& hash) {
  return static_cast<size_t>(static_cast<unsigned __int128>(hash.high) * buckets.count() >> 64);
}

}  // namespace

Shells::Shells(uint64_t facets, const Budget& budget, bool bounded)
    : most_(bounded ? std::max<uint64_t>(budget.bytes / 6 / kBytesInBatch, 4096) : ~uint64_t{0}),
      memory_(bounded ? std::max<uint64_t>(budget.bytes / 12, uint64_t{1} << 20) : ~uint64_t{0}) {
  if (facets > most_) {
    vertices_.emplace(buckets_for(facets / 2), memory_, budget.folder);
    file_ = std::make_unique<SpillFile>(budget.folder, facets * sizeof(uint32_t));
  }
  by_vertices_.emplace(buckets_for(facets), memory_, budget.folder);
}

void Shells::add(const Facet& facet) {
  if (batch_.size() >= most_) end_batch();
  const std::array<VertexHash, 3> hashes = vertex_hashes(facet);
  std::array<uint32_t, 3> v;
  for (int i = 0; i < 3; ++i) {
    v[i] = recent_.number(hashes[i].low, hashes[i].high);
    if (v[i] == RecentVertices::kNone) {
      v[i] = numbers_.find_or_add(hashes[i]);
      recent_.keep(hashes[i].low, hashes[i].high, v[i]);
    }
    if (v[i] == vertex_groups_.size()) vertex_groups_.add();
  }
  for (int i = 1; i < 3; ++i) vertex_groups_.join(v[i], v[0]);
  const FacetKey f(hashes);
  batch_.push_back({f.key, v[0], f.odd, three_different(hashes)});
}

void Shells::end_batch() {
  constexpr uint32_t kNone = ~uint32_t{0};
  std::vector<uint32_t> group(vertex_groups_.size(), kNone);  // by the vertex that stands for it
  group_of_facet_.reserve(group_of_facet_.size() + batch_.size());
  for (uint64_t i = 0; i < batch_.size(); ++i) {
    const BatchFacet& f = batch_[i];
    uint32_t& g = group[vertex_groups_.of(f.vertex)];
    if (g == kNone) {
      g = groups_.add();
      facets_.push_back(0);
      cancelled_.push_back(0);
    }
    facets_[g] += f.three_different;
    group_of_facet_.push_back(g);
    if (f.three_different) by_vertices_->add(bucket_of(*by_vertices_, f.key), {f.key, facets_before_ + i, g, f.odd});
  }
  if (file_) {
    file_->write(facets_before_ * sizeof(uint32_t),
                 {reinterpret_cast<const uint8_t*>(group_of_facet_.data()), group_of_facet_.size() * sizeof(uint32_t)});
    group_of_facet_.clear();
  }
  facets_before_ += batch_.size();
  if (vertices_) {
    for (uint32_t v = 0; v < vertex_groups_.size(); ++v)
      vertices_->add(bucket_of(*vertices_, numbers_.hash(v)), {numbers_.hash(v), group[vertex_groups_.of(v)]});
    numbers_ = {}, recent_ = {};
    vertex_groups_ = Groups();
  } else {
    first_group_of_vertex_.resize(vertex_groups_.size());
    for (uint32_t v = 0; v < vertex_groups_.size(); ++v) first_group_of_vertex_[v] = group[vertex_groups_.of(v)];
  }
  batch_.clear();
}

void Shells::finish() {
  end_batch();
  batch_ = {};
  vertex_groups_ = Groups();
  if (vertices_) join_groups();
  find_repeated();
  number_shells();
}

void Shells::join_groups() {
  for (size_t b = 0; b < vertices_->count(); ++b) {
    std::vector<VertexRecord> records = vertices_->load(b);
    std::ranges::sort(records, {}, &VertexRecord::vertex);
    for (size_t i = 1; i < records.size(); ++i)
      if (records[i].vertex == records[i - 1].vertex) groups_.join(records[i].group, records[i - 1].group);
  }
}

void Shells::find_repeated() {
  for (size_t b = 0; b < by_vertices_->count(); ++b) {
    std::vector<FacetRecord> records = by_vertices_->load(b);
    std::ranges::sort(records, [](const FacetRecord& p, const FacetRecord& q) { return std::tie(p.key, p.facet) < std::tie(q.key, q.facet); });
    for (size_t i = 0; i < records.size();) {
      const size_t first = i;
      int64_t net = 0;
      for (; i < records.size() && records[i].key == records[first].key; ++i) net += records[i].odd ? -1 : 1;
      if (i == first + 1) continue;
      if (repeats_.empty()) repeats_.resize(facets_before_);
      for (size_t k = first + 1; k < i; ++k) repeats_[records[k].facet] = true;
      cancelled_[records[first].group] += i - first - static_cast<uint64_t>(std::abs(net));
    }
  }
  by_vertices_.reset();
}

void Shells::number_shells() {
  std::vector<uint64_t> facets, cancelled;
  group_shell_.resize(groups_.size());
  for (uint32_t g = 0; g < groups_.size(); ++g) {
    const uint32_t root = groups_.of(g);  // the least group of the shell, so the loop meets it first
    if (root == g) {
      group_shell_[g] = static_cast<uint32_t>(facets.size());
      facets.push_back(0);
      cancelled.push_back(0);
    }
    const uint32_t shell = group_shell_[g] = group_shell_[root];
    facets[shell] += facets_[g];
    cancelled[shell] += cancelled_[g];
  }
  facets_ = std::move(facets);
  cancelled_ = std::move(cancelled);
  groups_ = Groups();
}

std::vector<uint32_t> Shells::of(const std::vector<Vec3>& vertices) const {
  std::vector<uint32_t> out(vertices.size());
  if (!vertices_) {
    for (size_t i = 0; i < vertices.size(); ++i) out[i] = group_shell_[first_group_of_vertex_[numbers_.find(vertex_hash(vertices[i]))]];
    return out;
  }
  std::vector<std::pair<VertexHash, size_t>> wanted;
  for (size_t i = 0; i < vertices.size(); ++i) wanted.emplace_back(vertex_hash(vertices[i]), i);
  const auto bucket = [&](const auto& w) { return bucket_of(*vertices_, w.first); };
  std::ranges::sort(wanted, {}, bucket);
  for (size_t i = 0; i < wanted.size();) {
    const size_t b = bucket(wanted[i]);
    std::vector<VertexRecord> records = vertices_->load(b);
    std::ranges::sort(records, {}, &VertexRecord::vertex);
    for (; i < wanted.size() && bucket(wanted[i]) == b; ++i)
      out[wanted[i].second] = group_shell_[std::ranges::lower_bound(records, wanted[i].first, {}, &VertexRecord::vertex)->group];
  }
  return out;
}

uint32_t Shells::of_facet(uint64_t facet) const {
  if (!file_) return group_shell_[group_of_facet_[facet]];
  if (facet < block_first_ || facet >= block_first_ + block_.size()) {
    block_first_ = facet / kBlock * kBlock;
    block_.resize(std::min<uint64_t>(kBlock, facets_before_ - block_first_));
    file_->read(block_first_ * sizeof(uint32_t), {reinterpret_cast<uint8_t*>(block_.data()), block_.size() * sizeof(uint32_t)});
  }
  return group_shell_[block_[facet - block_first_]];
}

}  // namespace teracell::mesher
