"""What can be asked of meshes, files and streams, and how meshes leave."""
import json
import os
import pathlib
import sys
import tempfile
import types
import unittest
from unittest import mock

import support
from support import BOX, ball, cube, np

import laves


class Checks(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.mesh = laves.mesh("sphere(1) - cylinder{r=0.4}", size=0.15)

    def test_quality_is_what_the_library_says(self):
        quality, check = self.mesh.quality(), self.mesh.check()
        for name in ("min_dihedral", "max_dihedral", "radius_ratio", "radius_edge", "volume_length"):
            ours, theirs = getattr(quality, name), getattr(check, name)
            self.assertEqual(ours.shape, (self.mesh.tet_count,))
            np.testing.assert_allclose([ours.min(), ours.max(), ours.mean(), ours.std()], [theirs.min, theirs.max, theirs.mean, theirs.deviation],
                                       rtol=1e-9, err_msg=name)
        self.assertEqual(int(quality.radius_ratio.argmin()), check.radius_ratio_tet)
        self.assertAlmostEqual(quality.volume.sum(), check.volume)
        self.assertIn("min_dihedral", repr(quality))

    def test_quality_of_odd_tets(self):
        points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0]], float)
        quality = laves.Mesh.from_arrays(points, [[0, 1, 2, 3], [0, 2, 1, 3], [0, 1, 2, 4]]).quality()
        np.testing.assert_allclose(quality.volume, [1 / 6, -1 / 6, 0])
        self.assertTrue(quality.radius_ratio[0] > 0 > quality.radius_ratio[1])
        self.assertEqual(len(laves.Mesh.from_arrays(np.empty((0, 3)), np.empty((0, 4), int)).quality().volume), 0)

    def test_check(self):
        check = laves.check(self.mesh, "sphere(1) - cylinder{r=0.4}")
        self.assertTrue(check.valid and check.has_distance)
        self.assertEqual((check.genus, check.components), (1, 1))
        self.assertEqual(check.histogram.sum(), 6 * self.mesh.tet_count)
        tets = self.mesh.tets.copy()
        tets[7] = tets[7, [1, 0, 2, 3]]
        turned = laves.Mesh.from_arrays(self.mesh.points, tets).check()
        self.assertEqual((turned.valid, turned.inverted_tets), (False, 1))
        json.dumps(check.as_dict())

    def test_places(self):
        count, places = self.mesh.outside_window(60, 74, capacity=5)
        self.assertGreater(count, 5)
        self.assertEqual(len(places), 5)
        self.assertEqual(places[0].place.shape, (3,))
        self.assertEqual(self.mesh.outside_window(1, 179), (0, []))
        count, places = self.mesh.further_than(1e-4)
        self.assertGreater(count, 0)
        self.assertEqual(self.mesh.further_than(1)[0], 0)

    def test_features(self):
        points, faces, _ = cube()
        found = laves.mesh(points, faces, size=0.1).check_features()
        self.assertEqual((found.creases, found.corners, found.corners_kept), (12, 8, 8))
        rounded = laves.mesh(points, faces, size=0.1, feature_angle=0)
        lost = rounded.check_features(places=3)
        self.assertLess(lost.corners_kept, 8)
        self.assertTrue({p.fault for p in lost.places} >= {"crease", "corner"})
        self.assertEqual(rounded.check_features(angle=0).creases, 0)

    def test_certificate(self):
        certificate = self.mesh.certificate
        self.assertTrue(certificate.promise_holds and certificate.has_input and certificate.has_options)
        self.assertEqual(certificate.check.tets, self.mesh.tet_count)
        self.assertIs(certificate, self.mesh.certificate)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "mesh.certificate.json")
            certificate.write(path)
            self.assertEqual(json.loads(path.read_text()), certificate.as_dict())
            self.assertEqual(self.mesh.verify(path), [])
            other = laves.mesh("sphere(1)", size=0.3)
            self.assertTrue(any("hash" in s or "tets" in s for s in other.verify(path)))
            path.write_text("{}")
            self.assertRaises(laves.InputError, laves.Certificate.read, path)
        self.assertFalse(self.mesh.certify(distances=False).check.has_distance)
        self.assertEqual(certificate.command, [])
        words = ["laves", "mesh", "", "é"]
        self.assertEqual(self.mesh.certify(distances=False, command=words).command, words)
        self.assertEqual(self.mesh.certify(distances=False, command=words).as_dict()["command"], words)
        self.assertIn("holds", repr(certificate))


class Files(unittest.TestCase):
    def test_every_format(self):
        mesh = laves.mesh("sphere(1)", size=0.3)
        ends = {"gmsh22": "msh", "gmsh41": "msh", "medit": "mesh", "tetgen": "ele", "abaqus": "inp", "nastran": "bdf", "exodus": "exo",
                "dmtet": "npz"}
        read = ("vtu", "gmsh22", "gmsh41", "medit", "tetgen", "vtk", "abaqus")
        surfaces = ("stl", "obj", "ply", "off")
        with tempfile.TemporaryDirectory() as folder:
            for name, streams in laves.formats().items():
                path = pathlib.Path(folder, "mesh." + ends.get(name, name))
                for ascii_ in (False, True):
                    mesh.write(path, name, ascii=ascii_)
                    if name in read:
                        again = laves.read(path)
                        # Abaqus reads numbers of twenty characters at most.
                        np.testing.assert_allclose(again.points, mesh.points, rtol=0, atol=1e-15 if name == "abaqus" else 0)
                        np.testing.assert_array_equal(again.tets, mesh.tets)
                    elif name in surfaces:
                        self.assertTrue(laves.info(path).closed)
                    elif name in ("npz", "dmtet"):
                        arrays = np.load(path)
                        tets = next(arrays[key] for key in arrays if arrays[key].ndim == 2 and arrays[key].shape[1] == 4)
                        np.testing.assert_array_equal(tets, mesh.tets)
                    else:
                        self.assertGreater(path.stat().st_size, 500)
            self.assertEqual(laves.format_of("a.mesh"), "medit")
            self.assertIsNone(laves.format_of("a.xyz"))
            with self.assertRaises(laves.Error):
                mesh.write(pathlib.Path(folder, "a.xyz"))
            with self.assertRaises(laves.Error):
                mesh.write(pathlib.Path(folder, "a.vtu"), compression=10)

    def test_streams(self):
        held, streamed = laves.mesh("sphere(1)", size=0.1), laves.mesh("sphere(1)", size=0.1, streamed=True)
        self.assertTrue(streamed.streamed and not held.streamed)
        self.assertEqual((streamed.tet_count, streamed.vertex_count), (held.tet_count, held.vertex_count))
        np.testing.assert_array_equal(np.vstack(list(streamed.point_ranges(1000))), held.points)
        np.testing.assert_array_equal(np.vstack(list(streamed.tet_ranges(1000))), held.tets)
        np.testing.assert_array_equal(streamed.read_tets(100, 7), held.tets[100:107])
        np.testing.assert_array_equal(held.read_points(held.vertex_count - 3), held.points[-3:])
        np.testing.assert_array_equal(streamed.faces, held.faces)
        for wrong in (lambda: streamed.points, lambda: streamed.tets, streamed.quality, streamed.check, lambda: streamed.read_points(-1, 2),
                      lambda: streamed.read_tets(0, held.tet_count + 1)):
            self.assertRaises(laves.OptionError, wrong)
        self.assertIn("tets", streamed._repr_html_())
        with tempfile.TemporaryDirectory() as folder:
            one, two = pathlib.Path(folder, "held.vtu"), pathlib.Path(folder, "streamed.vtu")
            held.write(one)
            streamed.write(two)
            self.assertEqual(one.read_bytes(), two.read_bytes())
            found = laves.check_file(two, laves.Domain("sphere(1)"), min_dihedral=60, places=3)
            self.assertTrue(found.check.valid and found.check.has_distance)
            self.assertEqual(len(found.places), 3)
            self.assertEqual(found.check.tets, held.tet_count)
            self.assertRaises(laves.InputError, laves.check_file, pathlib.Path(folder, "none.vtu"))

    def test_a_streamed_mesh_of_a_function(self):
        """It may ask its domain after all else has gone."""
        mesh = laves.mesh(lambda p: ball(p), bounds=BOX, size=0.3, streamed=True)
        np.testing.assert_array_equal(mesh.read_points(), laves.mesh(ball, bounds=BOX, size=0.3).points)

    def test_tiling(self):
        mesh = laves.tiling((2, 2, 2), 0.5)
        self.assertEqual(mesh.lattice_tet_count, mesh.tet_count)
        self.assertAlmostEqual(mesh.check().max_dihedral.max, 74.21, places=1)


class Elsewhere(unittest.TestCase):
    def test_meshio(self):
        mesh = laves.mesh("tag('skin', sphere(1))", size=0.3)
        try:
            import meshio
        except ImportError:  # then only what it is called with
            meshio = types.SimpleNamespace(Mesh=lambda points, cells, **more: types.SimpleNamespace(points=points, cells=dict(cells), **more))
            with mock.patch.dict(sys.modules, meshio=meshio):
                made = mesh.to_meshio()
            self.assertIs(made.cells["tetra"].dtype.type, np.int32)
            return
        made = mesh.to_meshio()
        np.testing.assert_array_equal(made.cells_dict["tetra"], mesh.tets)
        np.testing.assert_array_equal(made.cells_dict["triangle"], mesh.faces)
        self.assertIn("skin", made.field_data)
        self.assertEqual(laves.mesh(made, size=0.4).domain.info.triangle_count, mesh.face_count)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "mesh.vtu")
            made.write(path)
            self.assertEqual(laves.read(path).tet_count, mesh.tet_count)

    def test_improve(self):
        ball = laves.mesh("sphere(1)", size=0.3)
        noise = np.random.default_rng(7)
        inner = np.setdiff1d(np.arange(ball.vertex_count), ball.faces)
        points = ball.points.copy()
        points[inner] += noise.uniform(-0.07, 0.07, (len(inner), 3))
        spoilt = laves.Mesh.from_arrays(points, ball.tets)
        self.assertTrue(spoilt.check().valid)
        better = spoilt.improve(min_dihedral=35, max_dihedral=130)
        self.assertGreater(better.report.after.min_dihedral.min, better.report.before.min_dihedral.min + 5)
        self.assertEqual(better.report.outside_after, 0)
        self.assertAlmostEqual(better.check().volume, spoilt.check().volume, places=9)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "spoilt.mesh")
            spoilt.write(path)
            self.assertEqual(laves.improve(path, min_dihedral=35, max_dihedral=130).hash, better.hash)
        with self.assertWarns(laves.TargetMissed):
            kept = spoilt.improve(min_dihedral=60, max_dihedral=80, passes=1)
        self.assertGreater(kept.report.outside_after, 0)
        with self.assertRaisesRegex(TypeError, "min_dihedral"):
            spoilt.improve(min_dihedrall=3)
        points[ball.tets[0]] = points[ball.tets[0][[1, 0, 2, 3]]]  # turned over
        with self.assertRaises(laves.InputError):
            laves.Mesh.from_arrays(points, ball.tets).improve()

    def test_pyvista(self):
        mesh = laves.mesh("sphere(1)", size=0.3)
        try:
            import pyvista
        except ImportError:  # then only what it is called with

            class Grid:
                def __init__(self, cells, points):
                    self.cells, self.points, self.cell_data = cells, points, {}

            fake = types.SimpleNamespace(UnstructuredGrid=Grid, CellType=types.SimpleNamespace(TETRA=10))
            with mock.patch.dict(sys.modules, pyvista=fake):
                grid = mesh.to_pyvista()
            np.testing.assert_array_equal(grid.cells[10], mesh.tets)
            return
        grid = mesh.to_pyvista()
        self.assertEqual(grid.n_cells, mesh.tet_count)
        self.assertAlmostEqual(grid.volume, mesh.check().volume, places=6)
        self.assertGreater(laves.mesh(pyvista.Sphere(), size=0.2).tet_count, 100)

    def test_picture(self):
        mesh = laves.mesh("sphere(1)", size=0.3)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "mesh.png")
            drawn = mesh.picture(path, "--size", "200x100")
            self.assertEqual(path.read_bytes(), drawn)
            self.assertEqual((drawn[:4], drawn[16:24]), (b"\x89PNG", bytes([0, 0, 0, 200, 0, 0, 0, 100])))
        html = mesh._repr_html_()
        self.assertIn("data:image/png;base64,", html)
        self.assertIn(f"{mesh.tet_count:,}", html)
        self.assertIn(f"{mesh.tet_count:,} tets", repr(mesh))
        with self.assertRaisesRegex(RuntimeError, "--colour"):
            mesh.picture(None, "--colour")
        with mock.patch.dict(os.environ, LAVES_PROGRAM="/nowhere/laves"):
            self.assertIsNone(mesh.picture())
            self.assertNotIn("image/png", mesh._repr_html_())
            self.assertIn("<table>", mesh._repr_html_())


if __name__ == "__main__":
    support.main()
