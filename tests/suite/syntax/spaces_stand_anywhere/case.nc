%
O 00 01
N 1 0 G 1 X 1 0.5 Y - 3. F 2 0 0
# 1 0 0 = 1 2 . 5
I F [ # 1 E Q # 0 ] G O T O 1 0 0
W H I L E [ #1 LT 3 ] DO 1
X - [ #22 + #4 ] Z 40. F [ #7 / 3. ]
#2 = S I N [ 30 ]   
E N D 1
M30
%
