"""Meshes from all kinds of sources, their arrays, and what is said about bad input."""
import gc
import os
import pathlib
import subprocess
import tempfile
import types
import unittest
import warnings
import weakref

import support
from support import BOX, ROOT, ball, cube, np

import laves
from laves import solids

KNOT = ROOT / "demo" / "knot.ply"


def write_off(path, points, faces):
    rows = [" ".join(map(repr, p)) for p in points.tolist()] + ["3 " + " ".join(map(str, f)) for f in faces.tolist()]
    pathlib.Path(path).write_text("\n".join(["OFF", f"{len(points)} {len(faces)} 0", *rows, ""]))


class Sources(unittest.TestCase):
    def setUp(self):
        self.points, self.faces, self.tags = cube()
        self.hash = laves.mesh(self.points, self.faces, size=0.1).hash

    def test_arrays(self):
        mesh = laves.mesh(self.points, self.faces, size=0.1)
        self.assertGreater(mesh.tet_count, 5000)
        self.assertTrue(mesh.check().valid)
        self.assertAlmostEqual(mesh.check().volume, 1, places=6)
        for faces in (self.faces.astype(np.uint32), self.faces.astype(np.int32), self.faces.astype(np.uint8), self.faces.tolist(),
                      np.asfortranarray(self.faces)):
            self.assertEqual(laves.mesh(self.points.tolist(), faces, size=0.1).hash, self.hash)
        self.assertEqual(laves.mesh(np.repeat(self.points, 2, axis=0)[::2], self.faces, size=0.1).hash, self.hash)
        self.assertEqual(laves.mesh(self.points.astype(np.float32), self.faces, size=0.1).hash, self.hash)

    def test_files(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "cube.off")
            write_off(path, self.points, self.faces)
            for name in (path, str(path), os.fsencode(path)):
                self.assertEqual(laves.mesh(name, size=0.1).hash, self.hash)
            script = pathlib.Path(folder, "part.lua")
            script.write_text("return surface('cube.off') - sphere(0.2)")
            self.assertEqual(laves.mesh(script, size=0.1).domain.info.format, "Lua script")

    def test_expressions(self):
        text = laves.mesh("sphere(1) - cylinder{r=0.4}", size=0.2)
        built = laves.mesh(solids.sphere(1) - solids.cylinder(r=0.4), size=0.2)
        self.assertEqual(text.hash, built.hash)

    def test_objects_with_points_and_faces(self):
        trimesh = types.SimpleNamespace(vertices=self.points, faces=self.faces)
        flat = np.hstack([np.full((12, 1), 3), self.faces]).ravel()
        pyvista = types.SimpleNamespace(points=self.points, faces=flat)
        quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
        polygons = types.SimpleNamespace(points=self.points, faces=np.array([n for q in quads for n in (4, *q)]))
        meshio = types.SimpleNamespace(points=self.points, cells_dict={"triangle": self.faces})
        grid = types.SimpleNamespace(points=self.points, cells_dict={10: None}, extract_surface=lambda: pyvista)
        for source in (trimesh, pyvista, polygons, meshio, grid):
            self.assertEqual(laves.mesh(source, size=0.1).hash, self.hash)
        with self.assertRaisesRegex(laves.InputError, "no triangles"):
            laves.mesh(types.SimpleNamespace(points=self.points, cells_dict={}))

    def test_functions(self):
        counts = []

        def phi(points):
            self.assertEqual((points.dtype, points.ndim, points.shape[1]), (np.float64, 2, 3))
            counts.append(len(points))
            points[:] += 0  # its own copy, which may be written to
            return ball(points)

        mesh = laves.mesh(phi, bounds=BOX, size=0.15)
        self.assertTrue(mesh.check().valid)
        self.assertEqual(mesh.domain.info.kind, "function")
        self.assertAlmostEqual(mesh.check(mesh.domain).volume, 4.18879, delta=0.1)
        self.assertGreater(np.mean(counts), 20)  # whole batches
        self.assertGreater(max(counts), 300)
        self.assertLess(abs(ball(mesh.points[np.unique(mesh.faces)])).max(), 1e-9)
        one, two = (laves.mesh(phi, bounds=BOX, size=0.15, threads=n).hash for n in (1, 2))
        self.assertEqual((one, two), (mesh.hash, mesh.hash))
        fast = laves.mesh(ball, bounds=BOX, size=0.15, lipschitz=1)
        self.assertTrue(fast.check().valid)
        integers = laves.mesh(lambda p: np.where(ball(p) < 0, -1, 1), bounds=BOX, size=0.3)
        self.assertGreater(integers.tet_count, 100)

    def test_domains_serve_many_meshes(self):
        domain = laves.Domain(KNOT)
        coarse, fine = domain.mesh(tets=3000), domain.mesh(tets=6000, threads=1)
        self.assertLess(coarse.tet_count, fine.tet_count)
        self.assertEqual(laves.mesh(domain, tets=3000).hash, coarse.hash)
        self.assertIs(coarse.domain, domain)
        self.assertRaises(TypeError, laves.mesh, domain, tags=[1])

    def test_values(self):
        domain = laves.Domain(self.points, self.faces)
        np.testing.assert_allclose(domain.evaluate([[0, 0, 0], [1, 0, 0], [0.5, 0, 0]]), [-0.5, 0.5, 0], atol=1e-12)
        self.assertEqual(domain.evaluate(np.empty((0, 3))).shape, (0,))
        np.testing.assert_allclose(laves.Domain(ball, bounds=BOX).evaluate([[0, 0, 0]]), [-1])

    def test_info(self):
        info = laves.info(self.points, self.faces)
        self.assertEqual((info.kind, info.triangle_count, info.closed, info.genus), ("surface", 12, True, 0))
        self.assertAlmostEqual(info.volume, 1)
        np.testing.assert_array_equal(info.lower, [-0.5] * 3)
        self.assertEqual(info.defects["open_edge"], 0)
        self.assertRaisesRegex(AttributeError, "it has kind", lambda: info.colour)
        with self.assertRaises(AttributeError):
            info.volume = 2
        self.assertIn("volume: 1", repr(info))
        self.assertEqual(info.as_dict()["lower"], [-0.5] * 3)

    def test_thin_places(self):
        self.assertAlmostEqual(laves.Domain(self.points * [1, 1, 0.1], self.faces).thin_places(4)[0].thickness, 0.1, places=6)
        self.assertEqual(laves.Domain("sphere(1)").gap_places(), [])

    def test_defects(self):
        domain = laves.Domain(self.points, self.faces[:-1], defects=True)
        self.assertEqual(domain.info.defects["open_edge"], 3)
        places = list(domain.defects)
        self.assertEqual([p.kind for p in places], ["open_edge"] * 3)
        self.assertEqual(places[0].corners.shape, (2, 3))
        with tempfile.TemporaryDirectory() as folder:
            domain.defects.write(pathlib.Path(folder, "defects.ply"))
            self.assertTrue(os.path.getsize(pathlib.Path(folder, "defects.ply")))
            with self.assertRaises(laves.OptionError):
                domain.defects.write(pathlib.Path(folder, "defects.xyz"))
        with self.assertRaises(laves.InputError) as refused:
            laves.Domain(self.points, self.faces[:-1], defects=True, close_holes=False)
        self.assertEqual(len(refused.exception.defects), 3)
        self.assertRaises(IndexError, lambda: domain.defects[3])
        self.assertRaises(laves.OptionError, lambda: laves.Domain(self.points, self.faces).defects)


class Options(unittest.TestCase):
    def test_tags_and_regions(self):
        points, faces, tags = cube()
        mesh = laves.mesh(points, faces, tags=tags, size=0.2, face_sources=True, feature_tags=True)
        self.assertEqual(set(mesh.face_tags), set(tags + 1))  # as of all surfaces: 1 + the tag of the input
        self.assertEqual(len(mesh.face_sources), mesh.face_count)
        np.testing.assert_array_equal(tags[mesh.face_sources] + 1, mesh.face_tags)
        self.assertIsNone(laves.mesh(points, faces, size=0.3).face_sources)
        part = laves.mesh(solids.region("core", solids.sphere(0.5)) + solids.sphere(1).region("shell").tag("skin"), size=0.2)
        self.assertEqual(set(part.region_groups), {"core", "shell"})
        self.assertIn("skin", part.face_groups)
        self.assertGreater((part.regions == part.region_groups["core"]).sum(), 100)

    def test_sizing(self):
        uniform = laves.mesh("sphere(1)", size=0.4)
        for sizing in ("0.2 + 0.3 * d", 0.2 + 0.3 * solids.d, laves.Sizing().points([[1, 0, 0]], 0.1).expression("0.4"),
                       laves.Sizing().curve([[1, 0, 0], [0, 1, 0]], size=0.1, radius=0.1)):
            mesh = laves.mesh("sphere(1)", size=0.4, sizing=sizing)
            self.assertGreater(mesh.tet_count, uniform.tet_count)
            self.assertTrue(mesh.check().valid)
        points, faces, tags = cube()
        tagged = laves.mesh(points, faces, tags=tags, size=0.4, sizing=laves.Sizing().tag(2, 0.1))
        self.assertGreater(tagged.tet_count, laves.mesh(points, faces, size=0.4).tet_count)
        with tempfile.TemporaryDirectory() as folder:
            curve, script = pathlib.Path(folder, "curve.txt"), pathlib.Path(folder, "size.lua")
            curve.write_text("1 0 0\n0 1 0\n")
            script.write_text("return 0.2 + 0.3 * d")
            by_file = laves.Sizing().curve_file(curve, 0.1)
            self.assertGreater(laves.mesh("sphere(1)", size=0.4, sizing=by_file).tet_count, uniform.tet_count)
            self.assertEqual(laves.mesh("sphere(1)", size=0.4, sizing=laves.Sizing().script(script)).hash,
                             laves.mesh("sphere(1)", size=0.4, sizing="0.2 + 0.3 * d").hash)
            image = pathlib.Path(folder, "size.nrrd")
            header = ("NRRD0004", "type: float", "dimension: 3", "space dimension: 3", "sizes: 2 2 2", "space origin: (-1,-1,-1)",
                      "space directions: (2,0,0) (0,2,0) (0,0,2)", "endian: little", "encoding: raw", "", "")
            image.write_bytes("\n".join(header).encode() + np.full(8, 0.2, "<f4").tobytes())
            self.assertGreater(laves.mesh("sphere(1)", size=0.4, sizing=laves.Sizing().background(image)).tet_count, uniform.tet_count)
        with self.assertRaises(laves.InputError):
            laves.Sizing().expression("0.1 +")
        with self.assertRaises(laves.OptionError):
            laves.Sizing().points([[0, 0, 0]], size=-1)

    def test_features(self):
        line = np.array([[1, 0, 0], [np.sqrt(0.5), np.sqrt(0.5), 0], [0, 1, 0]])
        mesh = laves.mesh("sphere(1)", size=0.2, features=laves.Features().points([[0, 0, 1]]).line([[1, 0, 0], line[1]]))
        self.assertTrue((mesh.points == [0, 0, 1]).all(axis=1).any())
        self.assertTrue((abs(mesh.points - [1, 0, 0]) < 1e-12).all(axis=1).any())
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "points.txt")
            path.write_text("0 0 1\n")
            self.assertEqual(laves.mesh("sphere(1)", size=0.2, features=laves.Features().file(path)).hash,
                             laves.mesh("sphere(1)", size=0.2, features=laves.Features().points([[0, 0, 1]])).hash)
        with self.assertRaisesRegex(laves.InputError, "off the surface|from the surface"):
            laves.mesh("sphere(1)", size=0.2, features=laves.Features().points([[0, 0, 2]]))

    def test_turned_lattice(self):
        turn = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
        self.assertNotEqual(laves.mesh("sphere(1)", size=0.3, align=turn @ turn @ turn).hash, laves.mesh("ellipsoid(1, 1, 1)", size=0.3, align="pca").hash)
        with self.assertRaises(laves.OptionError):
            laves.mesh("sphere(1)", align=np.eye(2))

    def test_functions_are_warned_of(self):
        def ball(p):
            return np.linalg.norm(p, axis=1) - 1

        def half_known(p):
            return np.where(p[:, 0] > 0.5, np.nan, ball(p))

        self.assertEqual(laves.mesh(ball, bounds=([-1] * 3, [1] * 3), size=0.2).report.warnings, [])
        said = laves.mesh(ball, bounds=([-1] * 3, [1, 1, 0.8]), size=0.2).report.warnings
        self.assertTrue(any("reaches beyond its bounds" in sentence for sentence in said), said)
        said = laves.mesh(half_known, bounds=([-1.2] * 3, [1.2] * 3), size=0.2).report.warnings
        self.assertTrue(any("gave no number" in sentence for sentence in said), said)

    def test_estimate(self):
        expected = laves.estimate("sphere(1)", size=0.05)
        self.assertAlmostEqual(expected.tets / laves.mesh("sphere(1)", size=0.05).tet_count, 1, delta=0.05)

    def test_missed_targets_warn(self):
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            mesh = laves.mesh("box(1, 1, 0.02)", tets=200)
        self.assertTrue(all(issubclass(w.category, laves.TargetMissed) for w in said))
        if said:
            self.assertTrue(said[0].filename.endswith("test_mesh.py"), said[0].filename)
        self.assertTrue(mesh.check().valid)


class Refusals(unittest.TestCase):
    def test_sentences(self):
        points, faces, tags = cube()
        with tempfile.TemporaryDirectory() as folder:
            broken = pathlib.Path(folder, "broken.stl")
            broken.write_bytes(b"solid")
            for kind, sentence, call in (
                    (laves.MissingFileError, "'there/is.stl' does not exist", lambda: laves.mesh("there/is.stl")),
                    (FileNotFoundError, "none.vtu", lambda: laves.read("none.vtu")),
                    (laves.InputError, "broken.stl", lambda: laves.mesh(broken)),
                    (ValueError, "sphere", lambda: laves.mesh("sphere(-1)")),
                    (laves.OptionError, r"shape \(n, 3\), not \(8, 2\)", lambda: laves.mesh(points[:, :2], faces)),
                    (laves.OptionError, r"faces\[11\] is \[.*9\], but there are 8 points",
                     lambda: laves.mesh(points, np.vstack([faces[:-1], [[0, 1, 9]]]))),
                    (laves.OptionError, "faces.*-1", lambda: laves.mesh(points, faces - 1)),
                    (laves.Error, "9", lambda: laves.mesh(points, np.vstack([faces[:-1], [[0, 1, 9]]]).astype(np.uint32))),
                    (laves.OptionError, "whole numbers", lambda: laves.mesh(points, faces + 0.5)),
                    (laves.OptionError, "tags must be 12", lambda: laves.mesh(points, faces, tags=tags[:-1])),
                    (laves.Error, "(?i)finite|number", lambda: laves.mesh(np.full((8, 3), np.nan), faces)),
                    (laves.OptionError, "array of numbers", lambda: laves.mesh([["a", "b", "c"]], faces)),
                    (laves.OptionError, "size", lambda: laves.mesh("sphere(1)", size=-1)),
                    (laves.OptionError, "size cannot be 'small'", lambda: laves.mesh("sphere(1)", size="small")),
                    (laves.OptionError, "'auto', 'snap', 'stuff'", lambda: laves.mesh("sphere(1)", method="best")),
                    (laves.OptionError, "tets", lambda: laves.mesh("sphere(1)", tets=0.5)),
                    (laves.OptionError, "laves.Features", lambda: laves.mesh("sphere(1)", features=[[0, 0, 1]])),
                    (TypeError, "do you mean 'size'", lambda: laves.mesh("sphere(1)", sise=1)),
                    (TypeError, "bounds", lambda: laves.mesh(ball)),
                    (laves.OptionError, r"shape \(2, 3\)", lambda: laves.mesh(ball, bounds=[0, 1])),
                    (laves.OptionError, "box", lambda: laves.mesh(ball, bounds=BOX[::-1])),
                    (TypeError, "faces are missing", lambda: laves.mesh(points)),
                    (TypeError, "winding", lambda: laves.mesh("sphere(1)", winding=0.7)),
                    (TypeError, "int", lambda: laves.mesh(5)),
                    (laves.OptionError, "threads", lambda: laves.mesh("sphere(1)", threads=-1)),
                    (MemoryError, "(?i)memory", lambda: laves.mesh("sphere(1)", tets=10**7, memory=10**6)),
                    (OSError, "nowhere", lambda: laves.mesh("sphere(1)", size=0.5).write("nowhere/at/all.vtu")),
                    (laves.OptionError, "one of 'auto', 'vtu'", lambda: laves.mesh("sphere(1)", size=0.5).write("a.vtu", "vtk5")),
                    (laves.OptionError, "does not know its solid", lambda: laves.tiling((1, 1, 1), 1).check_features()),
                    (TypeError, "laves.Domain", lambda: laves.mesh("sphere(1)", size=0.5).check("sphere(1)"))):
                with self.subTest(sentence):
                    self.assertRaisesRegex(kind, sentence, call)

    def test_nothing_is_left_of_what_failed(self):
        domain = laves.Domain("sphere(1)")
        before = domain.session.bytes
        self.assertRaises(laves.OptionError, domain.mesh, size=-1)
        self.assertEqual(domain.session.bytes, before)


class Arrays(unittest.TestCase):
    def test_no_copies(self):
        mesh = laves.mesh("sphere(1)", size=0.3)
        for array, shape, kind in ((mesh.points, (mesh.vertex_count, 3), np.float64), (mesh.tets, (mesh.tet_count, 4), np.int32),
                                   (mesh.faces, (mesh.face_count, 3), np.int32)):
            self.assertEqual((array.shape, array.dtype), (shape, kind))
            self.assertFalse(array.flags.owndata or array.flags.writeable)
            self.assertTrue(array.flags.c_contiguous)
        self.assertTrue(np.shares_memory(mesh.points, mesh.points))
        self.assertEqual((mesh.face_tags.shape, mesh.regions.shape), ((mesh.face_count,), (mesh.tet_count,)))
        self.assertRaises(ValueError, mesh.points.__setitem__, 0, 1)

    def test_arrays_outlive_their_mesh(self):
        mesh = laves.mesh("sphere(1)", size=0.3)
        points, copy = mesh.points[5:], mesh.points[5:].copy()
        alive = weakref.ref(mesh.handle)
        del mesh
        gc.collect()
        self.assertIsNotNone(alive())
        others = [laves.mesh("sphere(1)", size=0.3) for _ in range(5)]
        np.testing.assert_array_equal(points, copy)
        del points, others
        gc.collect()
        self.assertIsNone(alive())

    def test_garbage_in_any_order(self):
        """A cycle: Python ends its members in whatever order."""
        for _ in range(20):
            mesh = laves.mesh(ball, bounds=BOX, size=0.6)
            mesh.self = {"mesh": mesh, "points": mesh.points, "domain": mesh.domain, "session": mesh.session}
            ended = weakref.ref(mesh)
            del mesh
            gc.collect()
            self.assertIsNone(ended())

    def test_functions_are_let_go(self):
        def phi(points):
            return ball(points)

        alive = weakref.ref(phi)
        laves.mesh(phi, bounds=BOX, size=0.6)
        del phi
        gc.collect()
        self.assertIsNone(alive())

    def test_memory_is_given_back(self):
        domain = laves.Domain("sphere(1)")
        before = domain.session.bytes
        mesh = domain.mesh(size=0.2)
        self.assertGreater(domain.session.bytes, before)
        self.assertGreaterEqual(domain.session.peak_bytes, domain.session.bytes)
        del mesh
        gc.collect()
        self.assertEqual(domain.session.bytes, before)

    def test_from_arrays(self):
        mesh = laves.mesh("sphere(1)", size=0.3)
        again = laves.Mesh.from_arrays(mesh.points, mesh.tets.astype(np.int64), np.arange(mesh.tet_count) % 3)
        self.assertEqual(again.face_count, mesh.face_count)
        np.testing.assert_array_equal(again.points, mesh.points)
        self.assertEqual(set(again.regions), {0, 1, 2})
        self.assertRaises(laves.Error, laves.Mesh.from_arrays, mesh.points, mesh.tets + 10**6)
        self.assertRaises(laves.Error, laves.Mesh.from_arrays, mesh.points, mesh.tets.astype(np.int64) - 10)
        empty = laves.Mesh.from_arrays(np.empty((0, 3)), np.empty((0, 4), int))
        self.assertEqual((empty.points.shape, empty.tets.shape, empty.faces.shape), ((0, 3), (0, 4), (0, 3)))


class SecondOrder(unittest.TestCase):
    def test_nodes_are_on_the_surface(self):
        mesh = laves.mesh(solids.sphere(1), size=0.3)
        before = mesh.hash
        self.assertEqual((mesh.order, mesh.nodes.shape, mesh.tet_nodes.shape), (1, mesh.points.shape, mesh.tets.shape))
        report = mesh.curve()
        self.assertEqual((mesh.order, mesh.hash, len(mesh.nodes)), (2, before, report.nodes))
        self.assertEqual(report.on_surface, report.boundary_edges)
        self.assertGreater(report.least_jacobian, 0.5)
        self.assertLess(report.curved_mean, 0.05 * report.straight_mean)
        radii = np.linalg.norm(mesh.nodes[mesh.face_nodes], axis=2)
        self.assertLess(abs(radii - 1).max(), 1e-9)
        np.testing.assert_array_equal(mesh.tet_nodes[:, :4], mesh.tets)
        np.testing.assert_array_equal(mesh.nodes[:mesh.vertex_count], mesh.points)
        self.assertFalse(mesh.nodes.flags.writeable)
        with self.assertRaisesRegex(laves.OptionError, "second order already"):
            mesh.curve()

    def test_straight_nodes_need_no_domain(self):
        mesh = laves.Mesh.tiling((1, 1, 1), 0.1)
        with self.assertRaisesRegex(laves.OptionError, "does not know its solid"):
            mesh.curve()
        mesh.curve(straight=True)
        middles = mesh.nodes[mesh.tet_nodes[:, :2]].mean(axis=1)
        np.testing.assert_array_equal(mesh.nodes[mesh.tet_nodes[:, 4]], middles)

    def test_files(self):
        mesh = laves.mesh(solids.sphere(1), size=0.4)
        mesh.curve(min_jacobian=0.5, distances=False)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "ball.npz")
            mesh.write(path)
            with np.load(path) as arrays:
                np.testing.assert_array_equal(arrays["points"], mesh.nodes)
                np.testing.assert_array_equal(arrays["tets"], mesh.tet_nodes)
                np.testing.assert_array_equal(arrays["faces"], mesh.face_nodes)
            with self.assertRaisesRegex(laves.OptionError, "no elements of second order"):
                mesh.write(os.path.join(folder, "ball.stl"))


class Program(unittest.TestCase):
    def test_same_bytes(self):
        """The program's file and the package's, and both certificates."""
        with tempfile.TemporaryDirectory() as folder:
            for source, name in (("sphere(1) - cylinder{r=0.4}", "expression"), (str(KNOT), "surface")):
                theirs, ours = pathlib.Path(folder, name + ".vtu"), pathlib.Path(folder, name + "-python.vtu")
                subprocess.check_call([support.program(), "mesh", source, "--tets", "8k", "-o", theirs, "--quiet"])
                mesh = laves.mesh(source, tets=8000)
                mesh.write(ours)
                self.assertEqual(theirs.read_bytes(), ours.read_bytes())
                said = laves.Certificate.read(pathlib.Path(folder, name + ".certificate.json"))
                self.assertEqual(said.mesh_hash, mesh.certificate.mesh_hash)
                self.assertEqual(mesh.verify(said), [])
                self.assertTrue(mesh.certificate.promise_holds)
                again = laves.read(theirs)
                self.assertEqual(again.hash, mesh.hash)

    def test_certificates_from_another_folder(self):
        before = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(KNOT.parent)
            try:
                mesh = laves.mesh(KNOT.name, tets=2000)
                os.chdir(folder)
                self.assertEqual((mesh.certificate.input_name, len(mesh.certificate.input_hash)), (KNOT.name, 64))
            finally:
                os.chdir(before)

    def test_python_m_laves(self):
        import sys
        run = subprocess.run([sys.executable, "-m", "laves", "--version"], capture_output=True, text=True, check=True)
        self.assertEqual(run.stdout + run.stderr, f"laves {laves.__version__}\n")
        self.assertEqual(subprocess.run([sys.executable, "-m", "laves", "mesh"], capture_output=True, check=False).returncode, 1)


if __name__ == "__main__":
    support.main()
