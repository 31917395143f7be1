"""The prepared model of a brake: its bodies are divided into elements, condensed and coupled."""

from collections.abc import Sequence

from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake
from drumlin.fem.hp.division import RefinementLevel
from drumlin.fem.mesh.arc import DEFAULT_MESH_KIND
from drumlin.fem.preparation.cache import CacheOfCondensedBodies
from drumlin.fem.preparation.cache import indices_of_first_shoes_of_equal_shape as equal_shapes
from drumlin.fem.preparation.columns import make_condensed_shoes_of_hp_elements
from drumlin.fem.preparation.meshes import (
    DEFAULT_ELEMENTS_ALONG_LINING,
    UNSPLIT_MESH_AT_FILE_DEGREE,
    DegreeAndSplittingOfMesh,
    Mesher,
    condensed_bodies_of_mesh_files,
    make_condensed_shoes_from_meshes,
)
from drumlin.fem.preparation.scene import (
    PreparedModel,
    SecondsOfEachPhase,
    SingularPointsByShoeShape,
    messages_on_rigid_parts,
    messages_on_shoes_of_equal_shape,
    reason_against_finite_element_model,
)


def make_prepared_model(
    brake: Brake,
    level: RefinementLevel | None = None,
    places: SingularPointsByShoeShape | None = None,
    *,
    alike: Sequence[int] = (),
    elements: int = DEFAULT_ELEMENTS_ALONG_LINING,
    kind: str = DEFAULT_MESH_KIND,
    mesher: Mesher | None = None,
    raised: DegreeAndSplittingOfMesh = UNSPLIT_MESH_AT_FILE_DEGREE,
    cache: CacheOfCondensedBodies | None = None,
) -> PreparedModel:
    """Make the prepared model of a brake, in hp elements or on meshes.

    The model has a condensed body for each shape of shoe. Shoes of one shape share the body.

    Parameters
    ----------
    brake : the brake
    level : degree of hp elements, and their sizes at singular points; if None, every shoe without a
        file has a parametric mesh
    places : singular points of the pressure for each shape of shoe; they matter for hp elements
        only
    alike : for each shoe the index of the first shoe of the same shape, see
        `cache.indices_of_first_shoes_of_equal_shape`; if it is empty, the indices are computed here
    elements : number of elements along each lining with a parametric mesh
    kind : kind of the elements of a parametric mesh, "quad2", "quad1", "tri2" or "tri1"
    mesher : function that makes the mesh of a shoe without a file, in place of
        `parametric_mesh_of_shoe`; `elements` then holds for an elastic ring only, and no body is
        taken from the cache
    raised : degree of the displacements on meshes from files, and how their elements are split; if
        `level` is None, it has no effect, and these meshes keep their degree and elements
    cache : cache of condensed bodies; bodies found in it are used again, and new ones are added

    Raises
    ------
    BadInput
        if the finite elements do not apply to the brake, if the number of elements is out of range,
        or if a mesh file cannot be used
    NoAnswer
        if a contact problem has more nodes than are allowed, or if a stiffness is singular
    """
    reason = reason_against_finite_element_model(brake)
    if reason is not None:
        raise BadInput(f"fem does not apply to this brake: {reason}")
    seconds: SecondsOfEachPhase = {}
    cache = cache or CacheOfCondensedBodies()
    alike = alike or equal_shapes(brake)
    if level is None:
        made = make_condensed_shoes_from_meshes(brake, elements, kind, mesher, cache, seconds)
    else:
        of_files = condensed_bodies_of_mesh_files(brake, raised, alike, cache, seconds)
        made = make_condensed_shoes_of_hp_elements(
            brake, level, places, alike, cache, seconds, of_files
        )
    left_out = _messages_on_what_prepared_model_neglects(
        brake, len(set(alike))
    ) + messages_on_rigid_parts(brake)
    return PreparedModel(
        brake,
        made.bodies,
        made.ring,
        seconds,
        tuple(left_out),
        nodes_of_changed_shoe=made.nodes_of_changed_shoe,
        ring_under_contact_lines=made.ring_under_contact_lines,
        divisions=made.divisions,
        level=level,
        points=places or {},
    )


def _messages_on_what_prepared_model_neglects(brake: Brake, shapes: int) -> list[str]:
    """Messages that name what a prepared model does not contain.

    `shapes` is the number of different shapes of shoe in the brake.
    """
    lines = ["interior fields: recovered only for a file or a picture"]
    lines += messages_on_shoes_of_equal_shape(brake, shapes)
    if brake.friction == 0:
        lines.append("friction: mu = 0, symmetric, without the flexibility under drag")
    return lines
