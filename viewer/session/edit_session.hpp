#pragma once
/// \file Editing session: handles that one makes and drags, and the shape that follows.

#include <reduction/editing/edit_scene.hpp>
#include <reduction/editing/editor.hpp>
#include <viewer/session/view_model.hpp>

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace supple {

/// A handle as its user knows it.
struct EditHandle {
  Index id = 0;
  std::shared_ptr<const HandleRegion> region;  ///< name, nodes of the mesh, whether it may be moved
  RigidMotion motion = {};                     ///< from rest to where it is to be
  Point centre = Point::Zero();                ///< of its samples at rest [m]
};

/// The shape of least energy under handles that come, go and move. A solve starts from the last shape and goes no farther than
/// it can follow, so that a large motion takes several; settled() says when the handles are where they are to be. No threads
/// and no clock.
///
///     EditSession session(model);
///     const Index hand = session.add({.name = "hand", .nodes = nodes});
///     session.move(hand, RigidMotion::turn({0, 0, 1}, 0.3, wrist));
///     while (!session.settled()) (void)session.solve();
class EditSession {
 public:
  enum class Grab { No, Yes };  ///< whether a motion begins a drag: what undo goes back to

  static constexpr std::size_t most_handles = 64;

  explicit EditSession(std::shared_ptr<const ViewModel> model);

  /// Makes a handle that begins where its nodes are now. Nodes that the model holds are left out.
  /// \param region  without a name it gets one.  \return its id.
  /// \throws std::invalid_argument without nodes that are free, for nodes that do not exist, a name that is taken, or more than
  /// 64 handles.
  Index add(HandleRegion region);
  /// \throws std::invalid_argument for an id that does not exist, a handle that is not movable, or a motion by more than 100
  /// diagonals.
  void move(Index id, const RigidMotion& motion, Grab grab = Grab::No);
  void remove(Index id);  ///< \throws std::invalid_argument for an id that does not exist
  const std::vector<EditHandle>& handles() const { return now_.handles; }

  bool can_undo() const { return !past_.empty(); }
  bool can_redo() const { return !future_.empty(); }
  void
  undo();  ///< back to before a handle was made, removed or grabbed, to the very shape; nothing where there is no past
  void redo();
  /// Handles and shape to rest; undo leads back.
  void reset();

  /// The handles and where they are, which `supple edit` and load() take. \throws std::invalid_argument without handles.
  EditScene scene() const;
  /// Replaces all handles by those of a scene, and sends them on its edits from rest. \throws std::invalid_argument as add().
  void load(const EditScene& scene);

  /// Whether there is nothing to solve.
  bool settled() const { return settled_; }
  /// A solve towards where the handles are to be. A state that is not finite is not kept.
  SolveReport solve();
  /// Leaves the handles where the last solve has brought them.
  void give_up();

  const Vector& state() const { return editor_.state(); }
  double elastic_energy() const { return editor_.elastic_energy(); }  ///< [J]
  double control_energy() const;                                      ///< of the handles' springs [J]
  /// What the handles hold, over the diagonal; above held_over_diagonal_at_most the subspace does not follow them.
  double held() const;

 private:
  struct Moment {
    std::vector<EditHandle> handles;
    std::vector<RigidMotion> reached;  ///< by the handles so far
    std::uint64_t seed = 1;            ///< of their samples
    Loads loads;                       ///< of a loaded scene
    Vector q;
    bool settled = true;
  };

  EditHandle make(HandleRegion region);
  EditHandle& handle(Index id);
  Moment moment() const;  // all of the present
  void remember();        // it, for undo
  void restore(Moment moment);
  void unsettle();
  void regrasp();
  EditScene regions() const;
  /// Displacements of all nodes, right at the samples of handles.
  const Vector& displacements_of_samples() const;

  std::shared_ptr<const ViewModel> model_;
  Editor<AnySystem<Matrix>> editor_;
  Moment now_;  // its q and settled are those of editor_ and below
  std::deque<Moment> past_, future_;
  std::deque<std::vector<RigidMotion>>
      waypoints_;  // of all handles, before where they are to be: a loaded scene's edits
  Index next_id_ = 1;
  bool settled_ = true;
  int attempts_ = 0;
  mutable Vector displacements_;
};

}  // namespace supple
