"""Of a recorded model only bodies, joints, inertias, sites and primitive shapes reach MuJoCo, and no file is opened."""

import xml.etree.ElementTree as ET

import mujoco
import pytest

from symskill_pddl.demos.model_xml import kinematic_xml
from symskill_pddl.errors import FormatError

BODY = '<body name="b" pos="1 0 0"><freejoint/><geom name="g" size="0.1" {}/>{}</body>'


def model(more="", geom="", inside="", world=""):
    return f"<mujoco>{more}<worldbody>{BODY.format(geom, inside)}{world}</worldbody></mujoco>"


def test_what_is_kept_is_as_it_was():
    text = model(
        '<compiler angle="radian" meshdir="/etc"/><default><default class="d"><joint axis="0 1 0"/></default></default>',
        'contype="0" material="wood"',
        '<inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/><site name="s" pos="0 0 1"/>'
        '<frame euler="0 0 1"><body name="c"><joint class="d" range="0 1"/><geom type="box" size="1 1 1"/></body></frame>',
    )
    kept, shaped = kinematic_xml(text)
    assert shaped == {"b", "c"}
    found, wanted = (mujoco.MjModel.from_xml_string(t) for t in (kept, text.replace('material="wood"', "")))
    assert (
        (found.nbody, found.njnt, found.ngeom, found.nsite)
        == (wanted.nbody, wanted.njnt, wanted.ngeom, wanted.nsite)
        == (3, 2, 2, 1)
    )
    for name in ("body_pos", "body_quat", "jnt_axis", "jnt_range", "geom_size", "site_pos"):
        assert (getattr(found, name) == getattr(wanted, name)).all()


SECRET = "/etc/passwd"
FILES = [
    f'<asset><mesh name="m" file="{SECRET}"/><hfield name="h" file="{SECRET}"/></asset>',
    f'<asset><texture name="t" type="2d" file="{SECRET}"/></asset>',
    f'<extension><plugin plugin="bolt"><instance name="p"><config key="f" value="{SECRET}"/></instance></plugin></extension>',
    f'<asset><model name="other" file="{SECRET}"/></asset>',
    f'<visual><map/></visual><size memory="900G"/><keyframe><key qpos="1"/></keyframe><custom><text data="{SECRET}"/></custom>',
    f'<deformable><flex name="f" body="b"/><skin name="k" file="{SECRET}"/></deformable>',
    f'<default><geom type="mesh" mesh="m" material="{SECRET}"/><mesh scale="1 1 1"/></default>',
    f'<default><plugin file="{SECRET}"/></default><compiler assetdir="/etc" strippath="false"><lengthrange/></compiler>',
    '<option><flag/></option><actuator><plugin plugin="x"/></actuator><sensor/><tendon/><equality/><contact/>',
]


@pytest.mark.parametrize("more", FILES)
def test_nothing_that_names_a_file_is_kept(more):
    kept, _ = kinematic_xml(model(more))
    assert SECRET not in kept
    tags = {e.tag for e in ET.fromstring(kept).iter()}
    assert tags <= {
        "mujoco",
        "compiler",
        "default",
        "worldbody",
        "body",
        "frame",
        "inertial",
        "joint",
        "freejoint",
        "geom",
        "site",
    }


@pytest.mark.parametrize(
    "inside",
    [
        f'<geom type="mesh" mesh="m" file="{SECRET}"/>',
        f'<geom type="sdf" mesh="m"><plugin instance="p"/></geom><flexcomp2 file="{SECRET}"/>',
        f'<camera name="c"/><light name="l" texture="{SECRET}"/><plugin plugin="{SECRET}"/><skin file="{SECRET}"/>',
    ],
)
def test_nothing_that_names_a_file_is_kept_within_a_body(inside):
    kept, _ = kinematic_xml(model(inside=inside))
    assert SECRET not in kept
    assert mujoco.MjModel.from_xml_string(kept).ngeom == 1


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (model(f'<include file="{SECRET}"/>'), "the model has <include>"),
        (model(world=f'<body><include file="{SECRET}"/></body>'), "the model has <include>"),
        (model(world='<replicate count="1000000"><body/></replicate>'), "the model has <replicate>"),
        (model(world='<attach model="m" body="b" prefix="p"/>'), "the model has <attach>"),
        (model(world='<composite type="grid" count="1000 1000 1"/>'), "the model has <composite>"),
        (model(world=f'<flexcomp name="f" type="gmsh" file="{SECRET}"/>'), "the model has <flexcomp>"),
        (f'<!DOCTYPE m [<!ENTITY x SYSTEM "{SECRET}">]><mujoco><worldbody>&x;</worldbody></mujoco>', "document type declaration"),
        (
            "<!DOCTYPE m [" + "".join(f'<!ENTITY a{i} "{f"&a{i - 1};" * 10}">' for i in range(1, 20)) + "]><m>&a19;</m>",
            "document type",
        ),
        ("<mujoco><worldbody>" + "<body>" * 100_000, "elements, or 200 within one another"),
        (model(world="<body/>" * 200_001), "more than 200000 elements"),
        (model(geom='pos="0 NaN 0"'), "the model's <geom> has a 'pos' that is no number"),
        (model(world='<body pos="-inf 0 0"/>'), "the model's <body> has a 'pos' that is no number"),
        ("<mujoco>", "not well-formed XML"),
        ("", "not well-formed XML"),
        ("\ud800", "no Unicode"),
        ("<mujoco/>", "its root is <mujoco>"),
        (f"<{'x' * 500}/>", "its root is <x"),
    ],
)
def test_what_is_refused(text, message):
    with pytest.raises(FormatError, match=message) as caught:
        kinematic_xml(text)
    assert len(str(caught.value)) < 200
