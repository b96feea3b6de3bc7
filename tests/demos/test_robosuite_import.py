import json
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest

from symskill_pddl.demos import import_robosuite, load_demos, save_demos
from symskill_pddl.demos.importing import ImportConfig
from symskill_pddl.demos.replay import KinematicModel, kinematic_xml, object_name, type_name
from symskill_pddl.errors import FormatError, InputError, UnsafeError
from symskill_pddl.geometry import rotation_distance

DATA = Path(__file__).parents[1] / "data" / "robosuite"

# A hand on a lift, a box, a bin with a rim, a drawer; a mesh whose file exists nowhere.
ARM = """
<body name="robot{i}_base" pos="{i} 0 0">
  <joint name="robot{i}_lift" type="slide" axis="0 0 1"/>
  <geom type="mesh" mesh="gone" material="gone"/>
  <body name="hand{i}" pos="0 0 1" quat="0 1 0 0">
    <body name="eef{i}" pos="0 0 0.1"><site name="gripper{i}_grip_site"/></body>
    <body name="left{i}"><joint name="finger{i}_1" type="{joint}" axis="1 0 0" range="0 0.04"/></body>
    <body name="right{i}"><joint name="finger{i}_2" type="{joint}" axis="1 0 0" range="-0.04 0"/></body>
  </body>
</body>
"""
THINGS = """
<body name="bin1" pos="0 1 0.5"><geom type="box" size="0.2 0.2 0.01"/><site name="bin1_top" pos="0 0 0.01"/></body>
<body name="shelf" pos="0 2 0"><geom type="mesh" mesh="gone"/></body>
<body name="target" mocap="true"><geom type="sphere" size="0.01"/></body>
<body name="VisualCan"><geom type="box" size="1 1 1" contype="0" conaffinity="0"/></body>
<body name="empty" pos="0 3 0"><body name="cabinet_main" pos="0 0 0.5"><geom type="box" size="0.1 0.1 0.1"/>
  <body name="drawer" pos="0.1 0 0"><joint name="slide" type="slide" axis="1 0 0"/>
    <geom type="box" size="0.1 0.1 0.05" pos="0.1 0 0"/>
    <body name="knob" pos="0.2 0 0"><geom type="sphere" size="0.01"/></body></body></body></body>
<body name="can2_main" pos="0 0 1"><freejoint/><geom type="cylinder" size="0.03 0.06"/></body>
"""


def model_xml(arms: int = 1, joint: str = "slide") -> str:
    bodies = "".join(ARM.format(i=i, joint=joint) for i in range(arms))
    return (
        '<mujoco><compiler angle="radian" meshdir="/nowhere"/><asset><texture name="t" type="2d" file="t.png"/>'
        '<material name="gone" texture="t"/><mesh name="gone" file="gone.stl"/></asset>'
        f"<worldbody><camera name='c'/>{bodies}{THINGS}</worldbody>"
        '<actuator><motor joint="robot0_lift"/></actuator>'
        '<sensor><framepos objtype="site" objname="gripper0_grip_site"/></sensor></mujoco>'
    )


def write(path: Path, *, xml: str | None = None, n: int = 4, **changes) -> Path:
    """A recording of the model above: lift, fingers (2), drawer, can (7)."""
    qpos = np.zeros((n, 11))
    qpos[:, 0] = np.linspace(0, 0.3, n)
    qpos[:, 1], qpos[:, 2] = 0.03, -0.02
    qpos[:, 3] = np.linspace(0, 0.2, n)
    qpos[:, 4:11] = [0, 0, 1, 1, 0, 0, 0]
    values = {
        "states": np.column_stack([np.arange(n) * 0.05 + 3, qpos, np.zeros((n, 10))]),
        "actions": np.column_stack([np.zeros((n, 6)), np.linspace(-1, 1, n)]),
        **changes,
    }
    with h5py.File(path, "w") as file:
        data = file.create_group("data")
        data.attrs["env"] = "Tiny"
        group = data.create_group("demo_1")
        if xml != "":
            group.attrs["model_file"] = xml or model_xml()
        for name, array in values.items():
            if array is not None:
                group[name] = array
    return path


# -- real recordings ------------------------------------------------------------------------------------------------------


def test_lifts_raise_the_cube_while_the_gripper_holds_it():
    demos = import_robosuite(DATA / "panda_lift.hdf5")
    assert [d.where for d in demos] == ["panda_lift:demo_1", "panda_lift:demo_3"]
    for demo in demos:
        assert demo.task == "Lift"
        assert demo.objects == {"table": "table", "cube": "cube"}
        assert demo.extents["cube"] == pytest.approx((0.021, 0.020, 0.0207), abs=4e-4)
        np.testing.assert_allclose(np.diff(demo.times), 0.05, atol=1e-9)
        cube, hand = demo.pose("cube").p, demo.T_world_ee.p
        settled = cube[5, 2]
        assert 0.05 < cube[-1, 2] - settled < 0.09
        above_top = settled - demo.pose("table").p[0, 2]
        assert above_top == pytest.approx(demo.extents["cube"][2], abs=1e-3)
        rising = 5 + np.flatnonzero(cube[5:, 2] > settled + 0.01)  # the cube is spawned 1 cm above the table
        assert demo.gripper_closed[rising].all()
        assert np.linalg.norm(cube[rising] - hand[rising], axis=1).max() < 0.04
        assert not demo.gripper_closed[:100].any()


def test_the_aperture_is_the_cubes_width_when_it_is_held():
    for demo in import_robosuite(DATA / "panda_lift.hdf5"):
        assert demo.aperture.max() == pytest.approx(0.08, abs=1e-3)
        assert demo.aperture[-1] == pytest.approx(2 * demo.extents["cube"][0], abs=2.5e-3)


def test_the_hand_frame_points_down_and_opens_across_the_cube():
    for demo in import_robosuite(DATA / "panda_lift.hdf5"):
        R = demo.T_world_ee.rotation_matrix()
        assert R[-1, 2, 2] < -0.95  # z: out of the hand, to the table
        held = demo.T_world_ee[-1].inverse() @ demo.pose("cube")[-1]
        # flat faces of the cube lie in the fingers: y of the hand is an axis of the cube
        assert np.abs(held.rotation_matrix()[1]).max() > 0.99


def test_stacking_moves_one_cube_onto_the_other():
    (demo,) = import_robosuite(DATA / "panda_stack.hdf5", ImportConfig({"cubeA": "cube", "cubeB": "cube"}))
    assert demo.objects == {"table": "table", "cubeA": "cube", "cubeB": "cube"}
    assert demo.extents["cube"] == pytest.approx((0.025, 0.025, 0.025))
    a, b = demo.pose("cubeA").p, demo.pose("cubeB").p
    assert np.linalg.norm(np.diff(a[5:], axis=0), axis=1).sum() == pytest.approx(0.402, abs=0.015)
    assert np.linalg.norm(a[-1, :2] - b[-1, :2]) < 0.02
    assert a[-1, 2] - b[-1, 2] == pytest.approx(0.045, abs=2e-3)


def test_door_and_latch_turn():
    (demo,) = import_robosuite(DATA / "panda_door.hdf5")
    assert demo.objects == {"table": "table", "frame": "frame", "door": "door", "latch": "latch"}
    turned = {o: float(np.degrees(rotation_distance(demo.pose(o)[0], demo.pose(o)).max())) for o in demo.objects}
    assert turned["table"] == turned["frame"] == 0
    assert 20 < turned["door"] < 25
    assert 70 < turned["latch"] < 95


def test_an_import_can_be_saved_and_loaded(tmp_path):
    demos = import_robosuite(DATA / "panda_door.hdf5")
    save_demos(tmp_path / "panda_door.hdf5", demos)
    (loaded,) = load_demos(tmp_path / "panda_door.hdf5")
    np.testing.assert_array_equal(loaded.T_world_objects.vector(), demos[0].T_world_objects.vector())


def test_a_damaged_recording_is_refused_in_one_line(tmp_path):
    whole = (DATA / "panda_lift.hdf5").read_bytes()
    path = tmp_path / "lift.hdf5"
    for size in (0, 100, 2000, 50_000, len(whole) // 2, len(whole) - 1):
        path.write_bytes(whole[:size])
        with pytest.raises(FormatError, match="damaged or truncated") as caught:
            import_robosuite(path)
        assert str(path) in str(caught.value)
        assert "\n" not in str(caught.value)


# -- what becomes an object -----------------------------------------------------------------------------------------------


def test_objects_frames_and_names_of_a_model(tmp_path):
    (demo,) = import_robosuite(write(tmp_path / "tiny.hdf5"))
    # no robot, no mocap target, no picture, no empty body, no knob (part of the drawer); the shelf had a mesh only
    assert demo.objects == {"bin1": "bin", "shelf": "shelf", "cabinet": "cabinet", "drawer": "drawer", "can2": "can"}
    assert demo.extents == {"can": pytest.approx((0.03, 0.03, 0.06)), "drawer": pytest.approx((0.2, 0.1, 0.05))}
    np.testing.assert_allclose(demo.pose("bin1").p, np.tile([0, 1, 0.51], (4, 1)))  # its top
    np.testing.assert_allclose(demo.pose("drawer").p[-1], [0.3, 3, 0.5])
    np.testing.assert_allclose(demo.T_world_ee.p[:, 2], np.linspace(0.9, 1.2, 4))
    np.testing.assert_allclose(demo.T_world_ee.rotation_matrix()[0][:, 2], [0, 0, -1], atol=1e-12)
    np.testing.assert_allclose(demo.T_world_ee.rotation_matrix()[0][:, 1], [1, 0, 0], atol=1e-12)  # the fingers slide along x
    assert np.linalg.det(demo.T_world_ee.rotation_matrix()[0]) == pytest.approx(1)
    np.testing.assert_allclose(demo.aperture, 0.05)
    assert demo.gripper_closed.tolist() == [False, False, True, True]
    assert demo.times.tolist() == pytest.approx([0, 0.05, 0.1, 0.15])


def test_an_object_of_meshes_has_no_known_size():
    xml = model_xml().replace('<geom type="cylinder" size="0.03 0.06"/>', '<geom type="mesh" mesh="gone"/>')
    assert {o.name: o.half_size for o in KinematicModel(xml).objects}["can2"] is None


def test_bodies_whose_short_names_agree_keep_the_long_ones():
    xml = model_xml().replace('name="shelf"', 'name="can2_object"')
    assert [o.name for o in KinematicModel(xml).objects] == ["bin1", "can2_object", "cabinet", "drawer", "can2_main"]


def test_names_and_types():
    assert [object_name(n) for n in ("cube_main", "Door_root", "milk_object", "main", "_main")] == [
        "cube",
        "Door",
        "milk",
        "main",
        "_main",
    ]
    assert [type_name(n) for n in ("can12", "cubeA", "peg_1", "7")] == ["can", "cubeA", "peg", "7"]


def test_nothing_that_names_an_asset_survives():
    xml, shaped = kinematic_xml(model_xml())
    assert "gone" not in xml
    assert "nowhere" not in xml
    assert {"shelf", "robot0_base"} <= shaped
    assert "empty" not in shaped


# -- both layouts ---------------------------------------------------------------------------------------------------------


def test_robomimic_keeps_the_model_and_the_rate_elsewhere(tmp_path):
    path = write(tmp_path / "mimic.hdf5", xml="")
    with h5py.File(path, "r+") as file:
        file["data"].attrs["model_file"] = model_xml()
        file["data"].attrs["env_args"] = json.dumps({"env_name": "Can", "env_kwargs": {"control_freq": 10, "robots": ["Panda"]}})
        states = file["data/demo_1/states"][...]
        states[2:, 0] = states[1, 0]  # a clock that was reset
        file["data/demo_1/states"][...] = states
    (demo,) = import_robosuite(path)
    assert demo.task == "Can"
    assert demo.times.tolist() == pytest.approx([0, 0.1, 0.2, 0.3])


@pytest.mark.parametrize("place", ["tiny_model_1.xml", "models/model_1.xml", "model_1.xml"])
def test_a_model_beside_the_recording_is_found_and_its_path_mapped(tmp_path, place):
    path = write(tmp_path / "tiny.hdf5", xml="/home/someone/robosuite/models/model_1.xml")
    (tmp_path / place).parent.mkdir(exist_ok=True)
    (tmp_path / place).write_text(model_xml())
    assert len(import_robosuite(path)) == 1


def test_a_missing_model_says_where_it_is_looked_for(tmp_path):
    shutil.copy(DATA / "panda_door.hdf5", tmp_path / "panda_door.hdf5")
    with pytest.raises(InputError, match=r"its model 'model_1.xml' is missing; put it at one of '.*panda_door_model_1.xml'"):
        import_robosuite(tmp_path / "panda_door.hdf5")


# -- refusals -------------------------------------------------------------------------------------------------------------


def refused(path: Path, message: str, kind: type[InputError] = FormatError, **config) -> None:
    with pytest.raises(kind, match=message) as caught:
        import_robosuite(path, ImportConfig(**config))
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_two_arms_are_refused_by_their_robots_and_by_their_grippers(tmp_path):
    path = write(tmp_path / "two.hdf5", xml=model_xml(arms=2))
    refused(path, "only recordings of one arm can be imported, the model has 2 grippers")
    with h5py.File(path, "r+") as file:
        file["data"].attrs["env_args"] = json.dumps({"env_kwargs": {"robots": ["Panda", "Panda"]}})
    refused(path, r"only recordings of one arm can be imported, this one has 2 robots \(Panda, Panda\)")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"xml": ""}, "has no attribute 'model_file'"),
        ({"xml": "<mujoco><worldbody>"}, "not well-formed XML"),
        ({"xml": "<robot/>"}, "not a MuJoCo model: its root is <robot>"),
        ({"xml": "<mujoco><worldbody><body><joint axis='0 0 0'/></body></worldbody></mujoco>"}, "the model does not compile"),
        ({"xml": "<mujoco><worldbody/></mujoco>"}, r"the model has 0 grippers \(grip sites: none\)"),
        ({"xml": model_xml(joint="hinge")}, "only hands of two fingers with boxes or other simple shapes"),
        ({"states": None}, "there is no dataset 'states'; it has: actions"),
        ({"actions": None}, "there is no dataset 'actions'; it has: states"),
        ({"states": np.zeros((4, 9))}, "states have 9 numbers, the model needs 22"),
        ({"states": np.full((4, 22), np.nan)}, "'states' holds a number that is not finite, at row 0"),
        ({"states": np.zeros(22)}, r"'states' has to be numbers \(n >= 2, m >= 1\)"),
        ({"states": np.zeros((1, 22))}, "it has 1 samples, a demonstration needs at least 2"),
        ({"actions": np.zeros((3, 7))}, "3 actions do not match 4 states"),
        ({"states": np.array([["a"] * 3] * 3, dtype="S1")}, "'states' has to be numbers"),
    ],
)
def test_unfit_recordings(tmp_path, changes, message):
    refused(write(tmp_path / "tiny.hdf5", **changes), message)


def test_bad_descriptions_of_the_environment(tmp_path):
    path = write(tmp_path / "tiny.hdf5")
    for text in ("{", "[]", '{"env_kwargs": 3}'):
        with h5py.File(path, "r+") as file:
            file["data"].attrs["env_args"] = text
        refused(path, "attribute 'env_args' has to be a JSON object")


def test_files_that_are_no_recording(tmp_path, demo):
    refused(tmp_path / "none.hdf5", "does not exist", InputError)
    refused(tmp_path, "is a folder", InputError)
    with h5py.File(tmp_path / "x.hdf5", "w") as file:
        file["x"] = 1
    refused(tmp_path / "x.hdf5", r"no demonstrations \(data/demo_1, ...\); the file has: x")


def test_a_type_for_an_unknown_object(tmp_path):
    refused(
        write(tmp_path / "tiny.hdf5"),
        "unknown object 'cup'; the recordings have: bin1, cabinet",
        InputError,
        types={"cup": "cup"},
    )


@pytest.mark.simulation
def test_a_recording_of_the_installed_robosuite(tmp_path):
    robosuite = pytest.importorskip("robosuite")
    env = robosuite.make("Lift", robots="Panda", has_renderer=False, has_offscreen_renderer=False, use_camera_obs=False)
    env.reset()
    states, actions, hands, cubes = [], [], [], []
    for i in range(8):
        action = np.zeros(env.action_dim)
        action[2], action[-1] = -0.5, 1 if i > 4 else -1
        env.step(action)
        states.append(env.sim.get_state().flatten())
        actions.append(action)
        # what the simulator itself says of the same state, after its own forward pass
        env.sim.forward()
        hands.append(env.sim.data.get_site_xpos("gripper0_right_grip_site").copy())
        cubes.append(env.sim.data.get_body_xpos("cube_main").copy())
    path = write(tmp_path / "lift.hdf5", xml=env.sim.model.get_xml(), states=np.array(states), actions=np.array(actions))
    env.close()
    (demo,) = import_robosuite(path)
    assert demo.objects == {"table": "table", "cube": "cube"}
    np.testing.assert_allclose(demo.T_world_ee.p, hands, atol=1e-6)
    np.testing.assert_allclose(demo.pose("cube").p, cubes, atol=1e-6)
    assert demo.gripper_closed.tolist() == [False] * 5 + [True] * 3


# -- other layouts and choices --------------------------------------------------------------------------------------------


def silent(text: str) -> None:
    raise AssertionError(text)


def test_an_instruction_names_the_task_and_an_option_overrides_it(tmp_path):
    path = write(tmp_path / "suite.hdf5")
    with h5py.File(path, "r+") as file:
        file["data"].attrs["problem_info"] = json.dumps({"language_instruction": "put the bowl on the plate"})
    (demo,) = import_robosuite(path, remark=lambda _: None)
    assert demo.task == "put_the_bowl_on_the_plate"
    assert demo.attributes["lang"] == "put the bowl on the plate"
    assert import_robosuite(path, ImportConfig(task="Tidy"), remark=lambda _: None)[0].task == "Tidy"


def test_a_filter_key_chooses(tmp_path):
    path = write(tmp_path / "mixed.hdf5")
    with h5py.File(path, "r+") as file:
        file.copy("data/demo_1", "data/demo_2")
        file["mask/better"] = np.array([b"demo_2"])
    assert [d.name for d in import_robosuite(path, ImportConfig(filter_key="better"), remark=lambda _: None)] == ["demo_2"]


def test_robosuite_before_1_tells_its_gripper_otherwise(tmp_path):
    path = write(tmp_path / "old.hdf5", actions=None, gripper_actuations=np.array([[-1.0], [-1.0], [0.0], [0.0]]))
    (demo,) = import_robosuite(path, remark=lambda _: None)
    assert demo.gripper_closed.tolist() == [False, False, True, True]


TIPS = '<geom type="box" size="0.01 0.004 0.01" pos="{y} 0 0.1"/>'


@pytest.mark.parametrize("joint", ["slide", "hinge"])
def test_the_opening_is_between_the_tips_whatever_the_joints_read(joint):
    """Joints that read 0 half way; or that turn about y, tips 10 cm off: 0.03 rad is 3 mm each."""
    xml = model_xml(joint=joint).replace('range="0 0.04"/>', 'range="-0.01 0.02"/>' + TIPS.format(y=0.03))
    xml = xml.replace('range="-0.04 0"/>', 'range="-0.02 0.01"/>' + TIPS.format(y=-0.03))
    if joint == "hinge":
        xml = xml.replace('type="hinge" axis="1 0 0"', 'type="hinge" axis="0 1 0"')
    model = KinematicModel(xml)
    states = np.zeros((3, model.state_size))
    states[:, 5:9] = [0, 0, 1, 1]
    states[1, 2:4] = 0.01, -0.01
    states[2, 2:4] = 0.03, -0.03
    opened = model.replay(states).aperture
    moved = {"slide": [0.0, 0.02, 0.06], "hinge": 2 * 0.1 * np.sin([0.0, 0.01, 0.03])}[joint]
    np.testing.assert_allclose(opened, 0.04 + np.array(moved), atol=1e-3)


@pytest.mark.parametrize("how", ["virtual", "external", "link", "include", "size"])
def test_a_recording_that_reaches_outside_itself_is_refused_as_a_whole(tmp_path, how):
    path = tmp_path / "lift.hdf5"
    shutil.copy(DATA / "panda_lift.hdf5", path)
    with h5py.File(path, "r+") as file:
        name = min(file["data"])
        group = file["data"][name]
        shape, model = group["states"].shape, group.attrs["model_file"]
        if how == "include":
            group.attrs["model_file"] = model.replace("<worldbody>", '<include file="/etc/passwd"/><worldbody>', 1)
        else:
            del group["states"]
        if how == "virtual":
            layout = h5py.VirtualLayout(shape, "f8")
            layout[...] = h5py.VirtualSource("other.hdf5", "states", shape)
            group.create_virtual_dataset("states", layout)
        elif how == "external":
            group.create_dataset("states", shape, "f8", external=[("/etc/passwd", 0, 8 * shape[0] * shape[1])])
        elif how == "link":
            group["states"] = h5py.ExternalLink("other.hdf5", "/states")
        elif how == "size":
            group.create_dataset("states", (10**9, shape[1]), "f8", chunks=True)
    with pytest.raises(UnsafeError, match=rf"lift.hdf5.*{name}"):
        import_robosuite(path)
