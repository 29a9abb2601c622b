"""The page in a browser: it draws, a click and keys change what is shown, numbers are the tables', nothing is loaded."""

import re
import socket

import numpy as np
import pytest
from support.browser import browser_page
from support.commands import run

import pearlbvp as pb
from pearlbvp.explorer.page import explorer


@pytest.fixture(scope="module")
def branches():
    tube = pb.Tube(0.0, 10.0)
    return {
        "pearls": pb.branch(tube, "pearl", (1, 0), until={"v": 1.03}),
        "coil": pb.branch(tube, "coil", (1, 1), until={"v": 0.95}),
    }


@pytest.fixture(scope="module")
def page(branches, tmp_path_factory):
    file = tmp_path_factory.mktemp("page") / "p.html"
    file.write_text(explorer(branches).text)
    with browser_page(viewport={"width": 1200, "height": 900}) as page:
        page.goto(file.as_uri())
        yield page
        assert page.wrong == []
        assert page.asked == [file.as_uri()]


def pixels(page):
    """The surface's picture, as drawn."""
    return page.evaluate("document.getElementById('shape').toDataURL()")


def row(page):
    """The row shown, by column."""
    return page.evaluate(
        "Object.fromEntries([...document.querySelectorAll('#row dd')].map((e) => [e.dataset.column, e.textContent]))"
    )


def agrees(page, branch, point):
    shown, table = row(page), branch.table()
    assert list(shown) == list(table)
    assert shown["special"] == table["special"][point]
    for column in ("lambda1", "v", "E", "mu_crit", "force"):
        assert float(shown[column]) == pytest.approx(table[column][point], rel=1e-7, abs=1e-300)


def test_keys_and_clicks_choose_points(page, branches):
    page.keyboard.press("Home")
    page.wait_for_timeout(50)
    straight = pixels(page)
    agrees(page, branches["pearls"], 0)
    page.keyboard.press("End")
    pearl = pixels(page)
    assert pearl != straight
    last = len(branches["pearls"]) - 1
    agrees(page, branches["pearls"], last)
    page.keyboard.press("ArrowLeft")
    agrees(page, branches["pearls"], last - 1)
    page.keyboard.press("ArrowDown")
    agrees(page, branches["coil"], 0)
    # A click beside the mark of the pearls' last point: where it was, as the diagram has it.
    page.keyboard.press("ArrowUp")
    page.keyboard.press("End")
    box = page.locator("#here").bounding_box()
    page.keyboard.press("ArrowDown")
    page.keyboard.press("End")
    assert pixels(page) != pearl
    agrees(page, branches["coil"], len(branches["coil"]) - 1)
    page.mouse.click(box["x"] + box["width"] / 2 + 2, box["y"] + box["height"] / 2)
    agrees(page, branches["pearls"], last)
    assert pixels(page) == pearl


def test_colours_turns_and_the_critical_perturbation_change_the_picture(page):
    page.keyboard.press("End")
    seen = {pixels(page)}
    for colour in ("H", "K", "u"):
        page.keyboard.press("c")
        assert page.input_value("#colour") == colour
        seen.add(pixels(page))
    page.fill("#wave", "0.8")
    seen.add(pixels(page))
    box = page.locator("#shape").bounding_box()
    page.mouse.move(box["x"] + 200, box["y"] + 150)
    page.mouse.down()
    page.mouse.move(box["x"] + 260, box["y"] + 190, steps=3)
    page.mouse.up()
    seen.add(pixels(page))
    page.mouse.wheel(0, -300)
    page.wait_for_timeout(50)
    seen.add(pixels(page))
    assert len(seen) == 7
    page.click("#home")
    page.fill("#wave", "0")
    page.keyboard.press("c")


def test_two_points_stand_beside_each_other_and_branches_play(page, branches):
    page.locator("#diagram").focus()
    page.keyboard.press("Home")
    page.keyboard.press("p")
    page.keyboard.press("End")
    assert "point 0" in page.text_content("#caption2")
    assert f"point {len(branches['pearls']) - 1}" in page.text_content("#caption")
    page.keyboard.press("p")
    assert not page.is_visible("#other")
    page.keyboard.press("Space")
    for _ in range(100):
        page.wait_for_timeout(50)
        if page.get_attribute("#play", "aria-pressed") == "false":
            break
    agrees(page, branches["pearls"], len(branches["pearls"]) - 1)


def test_a_diagram_of_other_columns_is_another(page):
    before = page.get_attribute("#diagram .curve", "d")
    page.select_option("#y", "lambda2")
    assert page.get_attribute("#diagram .curve", "d") != before
    assert "pressure" in page.text_content("#diagram")


def test_the_page_may_load_nothing(page):
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(0.3)
        address = f"http://127.0.0.1:{server.getsockname()[1]}/x.png"
        assert page.evaluate(f"fetch('{address}').then(() => 'loaded', () => 'refused')") == "refused"
        page.evaluate(f"document.body.append(Object.assign(new Image(), {{src: '{address}'}}))")
        page.evaluate(
            "window.ran = 0; document.body.append(Object.assign(document.createElement('script'), {text: 'ran = 1'}))"
        )
        assert page.evaluate("window.ran") == 0
        with pytest.raises(TimeoutError):
            server.accept()


def test_the_page_names_no_address(branches):
    text = explorer(branches, title="</script><b>").text
    assert set(re.findall(r"https?://[\w./-]+", text)) <= {"http://www.w3.org/1999/xhtml", "http://www.w3.org/2000/svg"}
    assert not re.search(
        r"<(link|img|iframe)\b|\bsrc=\"", text.split("</style>")[1].split('<script type="application/json"')[0]
    )
    assert "</script><b>" not in text
    assert len(text) < 1e6


def test_a_notebook_shows_it_in_a_frame(page, branches):
    shown = branches["pearls"].explore(y="lambda2")
    assert shown._repr_html_().startswith('<iframe srcdoc="&lt;!doctype html&gt;')
    assert len(repr(shown)) < 200
    other = page.context.browser.new_page()
    other.set_content(shown._repr_html_())
    frame = other.frames[1]
    frame.wait_for_selector("#row dd")
    assert frame.text_content("#which").startswith(f"pearl, point {len(branches['pearls']) - 1}: v = 1.03")
    other.close()


def test_the_command_writes_branches_and_flows(page, branches, tmp_path, capsys):
    branches["pearls"].save(tmp_path / "b.h5")
    how = ["--point", "-1", "--perturb", "bump", "--delta", "0.05", "--time", "0.1"]
    assert run(capsys, "flow", "--from", tmp_path / "b.h5", *how, "--save", tmp_path / "f.h5")[0] == 0
    out = tmp_path / "p.html"
    status, _, err = run(capsys, "explore", tmp_path / "b.h5", tmp_path / "f.h5", "--radius", "50nm", "--out", out)
    assert status == 0
    assert "2 branches or flows" in err
    other = page.context.browser.new_page()
    other.goto(out.as_uri())
    assert float(row(other)["L"]) == 500
    other.keyboard.press("ArrowDown")
    assert "frame 0" in other.text_content("#which")
    first = pixels(other)
    other.keyboard.press("End")
    assert pixels(other) != first
    other.close()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--x", "nothing", "--out", "p.html"], "x: no branch here has"),
        (["--out", "p.pdf"], "--out: p.pdf has the ending .pdf"),
    ],
)
def test_a_mistake_is_said_in_a_line(branches, tmp_path, monkeypatch, capsys, words, said):
    monkeypatch.chdir(tmp_path)
    branches["coil"].save("c.h5")
    status, _, err = run(capsys, "explore", "c.h5", *words)
    assert (status, err.count("\n")) == (2, 1)
    assert said in err
    assert np.all([not file.name.endswith("html") for file in tmp_path.iterdir()])
