"""The page at its first press: the one test of the browser that `make test` runs."""

import asperity as asp
from asperity.app.config.keys import sections
from tests.browser.conftest import finished, link, rows


def test_the_usual_run(tab, served):
    page = tab(f"{served}#config={link({})}")
    assert finished(page)["shape"] == [200, 200]
    rough, solid = (
        asp.surfaces.gaussian((200, 200), rms=1.0, seed=0),
        asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0),
    )
    contact = asp.press(rough, solid, load=800.0)
    series = rows(page)
    times = series["time"][1:]
    assert series["area"] == asp.age(contact, times).dataset["area"].values.tolist()
    found = dict(page.evaluate("app.scene.finished.rows"))
    assert found["growth"].startswith("27")
    assert found["growth"] in page.locator("#summary").text_content()
    assert page.locator("#press").is_visible()
    # A law of creep is chosen by its name, whatever laws there are.
    page.click("#section-solid summary")
    laws = sections()["solid"]["spring_lattice"]["creep"].choices
    assert page.locator("[id='solid.creep'] option").all_inner_texts() == ["by default", *laws]
