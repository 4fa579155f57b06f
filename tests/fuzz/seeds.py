"""Valid inputs of text readers, from which fuzzing starts."""

BML = b"""<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">
<speech id="s"><text>It is <sync id="m"/>big.</text></speech><gesture id="g" lexeme="large" stroke="s:m+0.1"/>
<gaze id="z" target="left" start="g:end" end="4"/></bml>"""
FML = b"""<fml-apml><bml><speech id="s1"><text>a<tm id="tm1"/>b<tm id="tm2"/></text></speech></bml><fml>
<performative id="p1" type="greet" start="s1:tm1" end="s1:tm2" importance="0.5"/></fml></fml-apml>"""
SSML = b"""<speak>One <break time="300ms"/><emphasis level="strong">two</emphasis>
<prosody rate="slow">three</prosody></speak>"""
JSON_BML = b'{"id": "b", "behaviours": [{"type": "head", "id": "h", "lexeme": "NOD", "start": 0.5}]}'
TEXT = b"""# Title

Hello (waves), *this* is **big**: 1,000 robots! :-) `code` <b>x</b> $x^2$ [link](http://a.b) :wave:
"""
INERTIAL = b'<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
URDF = b"""<robot name="r"><link name="a">%s</link><link name="b">%s<visual><geometry><box size="1 1 1"/>
</geometry></visual></link><joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" effort="2" velocity="3"/></joint></robot>""" % (INERTIAL, INERTIAL)
MJCF = b"""<mujoco model="m"><worldbody><body name="a"><geom type="capsule" size="0.1 0.2" mass="1"/>
<body name="b" pos="0 0 1"><joint name="j" axis="0 1 0" range="-1 1"/><geom type="sphere" size="0.1" mass="1"/></body>
</body></worldbody></mujoco>"""
TEXTGRID = b"""File type = "ooTextFile"
Object class = "TextGrid"
xmin = 0
xmax = 1
tiers? <exists>
size = 1
item []:
    item [1]:
        class = "IntervalTier"
        name = "words"
        xmin = 0
        xmax = 1
        intervals: size = 1
        intervals [1]:
            xmin = 0
            xmax = 1
            text = "hello"
"""
WHISPER = b'{"segments": [{"words": [{"word": " hi", "start": 0.0, "end": 0.5}, {"word": " you"}]}]}'
ELEVENLABS = b"""{"alignment": {"characters": ["h", "i"], "character_start_times_seconds": [0, 0.1],
"character_end_times_seconds": [0.1, 0.2]}}"""
POLLY = b'{"time":6,"type":"word","start":0,"end":5,"value":"hello"}\n{"time":300,"type":"viseme","value":"k"}\n'
SUBTITLES = b"WEBVTT\n\n00:00.000 --> 00:01.000\nhello you\n\n2\n00:00:01,000 --> 00:00:02,500\nbye\n"
OBJ = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1/1 2/2 4/3\nf -1 -2 -3\n"
FEEDBACK = b'<blockProgress xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b:start" globalTime="1.5"/>'
CONTROLS = (
    b'{"do": "status", "id": 3}',
    b'{"do": "plan", "bml": "<bml/>"}',
    b'{"do": "reach", "side": "right", "target": [0.1, 0.2, 0.3]}',
    b'{"do": "interrupt", "block": "b"}',
    b'{"do": "hello", "token": "x"}',
    b'{"do": "style", "style": "calm"}',
)
