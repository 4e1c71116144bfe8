// The bodies of a scene: read, closed, and each shell given its fill rule.
#pragma once
#include <deque>
#include <functional>
#include <memory>

#include "mesher/caps.hpp"
#include "mesher/compose.hpp"
#include "mesher/facet_store.hpp"
#include "mesher/spill.hpp"
#include "mesher/survey.hpp"
#include "store/background.hpp"

namespace teracell {

// Where facets of a shell disagree with their neighbours on which side is out: edges that run the same way in both.
struct Flip {
  Vec3 at;  // the first vertex of the first of its edges, as the grid sees it
  uint64_t edges;
};

// Shells of a body that one fill rule serves.
struct Rule {
  bool used = false;
  std::string why;  // in words
  Caps caps;
};

// Tells by which rule a facet counts, where a body has shells of both. Not thread-safe.
class ShellRules {
 public:
  // Every shell with one of `vertices` goes by parity. REQUIRES: `shells` has all facets of the body.
  ShellRules(Survey shells, std::span<const Vec3> vertices);
  bool evenodd(const Vec3& vertex) { return evenodd_[shells_.shell_of(vertex)]; }
  uint64_t shells() const { return shells_.shells(); }
  uint64_t evenodd_shells() const { return evenodd_shells_; }

 private:
  Survey shells_;
  std::vector<bool> evenodd_;  // by shell_of
  uint64_t evenodd_shells_ = 0;
};

struct BodyFacets {
  SurfaceFile file;
  uint64_t first = 0;                  // when in memory: Bodies::facets has its facets at [first, first + file.facets), then its caps
  std::array<Rule, 2> rules;           // nonzero, evenodd
  std::shared_ptr<ShellRules> shells;  // when facets are oriented both ways and the rule is chosen by shell
  std::vector<Flip> flips;
  Vec3 lo, hi;                         // the box of its vertices, as the grid sees them
  bool cut_from_others = false;        // edges of its boundary belong to parts that were left out
};

// The layer of a body's facets under a rule (compose.hpp).
inline uint32_t layer_of(size_t body, bool evenodd) { return static_cast<uint32_t>(2 * body + evenodd); }

struct Bodies {
  bool in_memory = true;
  std::shared_ptr<FacetStore> facets = std::make_shared<FacetStore>();  // in the files' coordinates
  std::vector<BodyFacets> bodies;
  Vec3 lo, hi;  // the box of all vertices, as the grid sees them
  Vec3 area{};  // of the facets' projections along x, y, z

  // The survey of facets in memory decides no cell: it is made beside the work, from the files' coordinates.
  std::deque<Survey> surveys;
  std::unique_ptr<Background> helper;  // last: its jobs use the others
  std::vector<SurveyTotals> survey_totals();  // of each body; waits. REQUIRES: in_memory

  uint64_t facet_count() const;  // without caps
  bool float32() const;          // every vertex is one
};

// Reads every mesh, on one thread or two. Facets are kept in memory while they fit into `budget`; else they are to be
// read again. `tick` is called every few thousand facets, with the bodies read so far as a share of 1.
// An open surface is closed by caps, or an InputError that describes its boundary when the scene wants it strict.
Bodies read_bodies(const Scene& scene, int threads, const Budget& budget, const std::function<void(double)>& tick);

// Calls f with the facets of a body as its file has them: from memory, or from the file.
void for_each_facet(const SceneBody& body, const BodyFacets& found, const Bodies& bodies, const Budget& budget,
                    const std::function<void(const Facet&)>& f);
// Reads a body's file once more. InputError when it has changed.
void read_again(const SceneBody& body, const BodyFacets& found, const Budget& budget, const FacetSink& sink);

// A vertex as the grid sees it. Throws InputError when it leaves what coordinates may be.
Vec3 moved(const Vec3& p, const SceneBody& body);

}  // namespace teracell
