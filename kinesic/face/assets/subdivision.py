"""One level of Catmull-Clark subdivision as a matrix, worked out once for all positions of a mesh.

E. Catmull and J. Clark, Recursively generated B-spline surfaces on arbitrary topological meshes, Computer-Aided Design
1978; on open borders the cubic B-spline of the border.
"""

import numpy as np
import scipy
from numpy.typing import NDArray

Indices = NDArray[np.int32]


def refine(faces: Indices, vertices: int) -> tuple["scipy.sparse.csr_array", Indices]:
    """The finer mesh: a vertex for each vertex, edge and face, in this order, and four faces for each.

    Args:
        faces: (f, 4) corners of quadrangles that run round all in the same sense.
        vertices: their number, v.

    Returns:
        (v + e + f, v) stencil, whose product with positions gives the finer positions, and (4 f, 4) faces.
    """
    ends, edge_of = _edges(faces)
    count, total = len(faces), len(ends)
    middle = _incidence(np.repeat(np.arange(count), 4), faces.ravel(), (count, vertices)) / 4
    halfway = _incidence(np.repeat(np.arange(total), 2), ends.ravel(), (total, vertices)) / 2
    beside = _incidence(edge_of.ravel(), np.repeat(np.arange(count), 4), (total, count))
    border = _sums(beside) < 2
    between = _scaled(np.where(border, 1.0, 0.5), halfway) + _scaled(np.where(border, 0.0, 0.25), beside) @ middle
    kept = _corners(faces, ends, border, middle, halfway, vertices)
    stencil = scipy.sparse.csr_array(scipy.sparse.vstack([kept, between, middle]))
    centres = vertices + total + np.arange(count)
    after, before = vertices + edge_of, vertices + np.roll(edge_of, 1, axis=1)
    parts = [np.stack([faces[:, k], after[:, k], centres, before[:, k]], axis=1) for k in range(4)]
    return stencil, np.stack(parts, axis=1).reshape(-1, 4).astype(np.int32)


def _edges(faces: Indices) -> tuple[Indices, NDArray[np.intp]]:
    """(e, 2) ends of the edges, and (f, 4) the edge from each corner to the next."""
    both = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    ends, edge_of = np.unique(np.sort(both, axis=1), axis=0, return_inverse=True)
    return ends, edge_of.reshape(faces.shape)


def _corners(
    faces: Indices,
    ends: Indices,
    border: NDArray[np.bool_],
    middle: "scipy.sparse.csr_array",
    halfway: "scipy.sparse.csr_array",
    vertices: int,
) -> "scipy.sparse.csr_array":
    """(v, v) where the old vertices go: (F + 2 R + (n - 3) P) / n inside, (R + P) / 2 on a border."""
    count, total = len(faces), len(ends)
    faces_at = _incidence(faces.ravel(), np.repeat(np.arange(count), 4), (vertices, count))
    edges_at = _incidence(ends.ravel(), np.repeat(np.arange(total), 2), (vertices, total))
    open_at = edges_at @ scipy.sparse.diags_array(border.astype(float))
    outside = _sums(open_at) > 0
    valence = np.maximum(_sums(edges_at), 1.0)
    meeting = np.maximum(_sums(faces_at), 1.0)
    inner = np.where(outside, 0.0, 1.0 / valence)
    outer = np.where(outside, 0.5 / np.maximum(_sums(open_at), 1.0), 0.0)
    stays = np.where(outside, 0.5, 1.0 - 3.0 / valence)
    return (
        _scaled(inner / meeting, faces_at @ middle)
        + _scaled(2 * inner / valence, edges_at @ halfway)
        + _scaled(outer, open_at @ halfway)
        + scipy.sparse.diags_array(stays)
    ).tocsr()


def _incidence(
    rows: NDArray[np.generic], columns: NDArray[np.generic], shape: tuple[int, int]
) -> "scipy.sparse.csr_array":
    return scipy.sparse.csr_array((np.ones(len(rows)), (rows, columns)), shape=shape)


def _sums(matrix: "scipy.sparse.csr_array") -> NDArray[np.float64]:
    """Of each row."""
    return np.asarray(matrix.sum(axis=1)).ravel()


def _scaled(factors: NDArray[np.float64], matrix: "scipy.sparse.csr_array") -> "scipy.sparse.csr_array":
    """Each row times its factor."""
    return scipy.sparse.diags_array(factors) @ matrix
